#include "pairs.hpp"
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace trigrain {

std::vector<ReferencePair> reference_pairs() {
  std::ifstream in(TRIGRAIN_TEST_DATA "/tripairs_reference.csv");
  std::string line, field;
  std::getline(in, line); // header
  std::vector<ReferencePair> pairs;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    ReferencePair r;
    std::getline(row, r.pair.family, ',');
    std::getline(row, field, ',');
    std::array<double, 19> x;
    for (double& value : x) {
      if (!std::getline(row, field, ',')) throw std::runtime_error("short row: " + line);
      value = std::strtod(field.c_str(), nullptr);
    }
    r.pair.a = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}};
    r.pair.b = {{x[9], x[10], x[11]}, {x[12], x[13], x[14]}, {x[15], x[16], x[17]}};
    r.distance = x[18];
    pairs.push_back(r);
  }
  return pairs;
}

Triangles only(const Triangle& t) {
  Triangles triangles;
  triangles.push_back(t);
  return triangles;
}

Closest solve(const Kernel& kernel, const Triangle& a, const Triangle& b) {
  Hits hits;
  KernelCounts counts;
  const Triangles ta = only(a), tb = only(b);
  closest_of_all(kernel, ta.view(), tb.view(), {}, hits, counts);
  if (hits.size() != 1) throw std::runtime_error(std::string(kernel.name) + " did not answer for one pair");
  return hits[0].closest;
}

} // namespace trigrain
