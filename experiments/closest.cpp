// Distances of the triangle pairs of a file, one row out per row in, with an optional check against known distances.
#include "experiments/option_checks.hpp"
#include "kernels/kernels.hpp"
#include "kernels/name_table.hpp"
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <unistd.h>

namespace {

using namespace trigrain;
namespace fs = std::filesystem;

/// One row of a pair file.
struct Pair {
  Triangle a, b;
  std::optional<double> distance; ///< m
};

/// Where the columns of a pair file are; -1 if absent.
struct Columns {
  std::array<int, 18> coordinate;
  int distance = -1;
  int count = 0;
};

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == line.npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

[[noreturn]] void refuse(const std::string& what, const fs::path& file, std::int64_t line, const std::string& advice) {
  throw InputError(what + " (" + file.string() + ", line " + std::to_string(line) + "). " + advice);
}

Columns read_header(std::string_view line, const fs::path& file) {
  const auto names = split(line);
  const auto column = [&](std::string_view name) {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
  };
  Columns columns{.coordinate = {}, .distance = column("distance"), .count = static_cast<int>(names.size())};
  for (int k = 0; k < 18; ++k) {
    const std::string name{k < 9 ? 'a' : 'b', static_cast<char>('0' + k % 9 / 3), static_cast<char>('x' + k % 3)};
    if ((columns.coordinate[k] = column(name)) < 0)
      refuse("no column '" + name + "' in the header", file, 1, "Name the 18 columns a0x,a0y,a0z,...,b2z.");
  }
  return columns;
}

/// Decimal or C99 hexadecimal; must be finite.
double read_number(std::string_view field, const fs::path& file, std::int64_t line) {
  const std::string text(field);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || std::isspace(static_cast<unsigned char>(text[0])) || !std::isfinite(value))
    refuse("'" + text + "' is not a finite number", file, line, "Write it in decimal or as a hexadecimal float.");
  return value;
}

std::vector<Pair> read_pairs(const fs::path& file, bool check) {
  std::ifstream in(file);
  if (!in) throw InputError("cannot read '" + file.string() + "' (no such file, or no permission). Check the path.");
  std::vector<Pair> pairs;
  Columns columns;
  std::string line;
  std::int64_t number = 0;
  while (std::getline(in, line)) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      columns = read_header(line, file);
      if (check && columns.distance < 0)
        refuse("no column 'distance' to check against", file, 1, "Add it or leave --check out.");
      continue;
    }
    if (line.empty() && in.peek() == std::ifstream::traits_type::eof()) break;
    const auto fields = split(line);
    if (static_cast<int>(fields.size()) != columns.count)
      refuse(std::to_string(fields.size()) + " fields where the header has " + std::to_string(columns.count), file,
             number, "Give every row one field per column.");
    std::array<double, 18> c;
    for (int k = 0; k < 18; ++k) c[k] = read_number(fields[columns.coordinate[k]], file, number);
    Pair pair{.a = {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}},
              .b = {{c[9], c[10], c[11]}, {c[12], c[13], c[14]}, {c[15], c[16], c[17]}},
              .distance = {}};
    if (check) pair.distance = read_number(fields[columns.distance], file, number);
    pairs.push_back(pair);
  }
  if (number == 0) refuse("no header", file, 1, "Name the 18 columns a0x,a0y,a0z,...,b2z.");
  return pairs;
}

Closest solve(const Pair& pair, const Kernel& kernel) {
  Triangles a, b;
  a.push_back(pair.a);
  b.push_back(pair.b);
  Hits hits;
  KernelCounts counts;
  closest_of_all(kernel, a.view(), b.view(), {}, hits, counts);
  return hits[0].closest;
}

/// S = max(longest edge, largest coordinate), m: the unit of the error.
double scale(const Pair& pair) {
  double s = 0;
  for (const Triangle& t : {pair.a, pair.b}) {
    for (const auto& [u, v] : {std::pair{t.a0, t.a1}, {t.a1, t.a2}, {t.a2, t.a0}}) {
      s = std::max(s, std::sqrt(dot(u - v, u - v)));
      s = std::max({s, std::fabs(u.x), std::fabs(u.y), std::fabs(u.z)});
    }
  }
  return s;
}

/// Writes beside the target and renames, so that no half file is ever seen.
void write_answers(const std::vector<Closest>& answers, const fs::path& file) {
  const fs::path partial = file.string() + "." + std::to_string(::getpid()) + ".partial";
  std::string text = "id,distance,lower,px,py,pz,qx,qy,qz,fell_back\n";
  for (std::size_t id = 0; id < answers.size(); ++id) {
    const Closest& c = answers[id];
    text += std::to_string(id);
    for (const double x : {c.distance, c.lower, c.p.x, c.p.y, c.p.z, c.q.x, c.q.y, c.q.z}) {
      std::array<char, 32> digits; // to_chars: the shortest decimal that reads back as the same double
      text += ',';
      text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr);
    }
    text += c.fell_back ? ",1\n" : ",0\n";
  }
  std::ofstream out(partial, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) fs::rename(partial, file, error);
  if (!out || error) {
    fs::remove(partial, error);
    throw InputError("cannot write '" + file.string() +
                     "' (no such folder, no permission or disk full). Give another --out.");
  }
}

/// Prints one line; true if every distance is within tolerance x S.
bool check_answers(const std::vector<Pair>& pairs, const std::vector<Closest>& answers, double tolerance) {
  double worst = 0;
  std::size_t failures = 0, worst_row = 0;
  for (std::size_t id = 0; id < pairs.size(); ++id) {
    const double s = scale(pairs[id]), error = std::fabs(answers[id].distance - *pairs[id].distance);
    if (!(error <= tolerance * s)) ++failures;
    const double relative = s > 0 ? error / s : error;
    if (relative > worst) worst = relative, worst_row = id;
  }
  std::cout << "rows " << pairs.size() << ", worst error/S " << worst << " (id " << worst_row << "), tolerance "
            << tolerance << ", failures " << failures << '\n';
  return failures == 0;
}

} // namespace

int main(int argc, char** argv) {
  fs::path pair_file, out_file;
  std::string kernel_name = "hybrid-pair", precision_name = "double";
  bool check = false;
  double tolerance = 1e-14;
  CLI::App app{"Distance and closest points of every triangle pair of a CSV file."};
  app.add_option("pairs", pair_file, "columns a0x,a0y,a0z,...,b2z (m) and, for --check, distance (m)")->required();
  app.add_option("--kernel", kernel_name, names_of(kernels()))->capture_default_str();
  app.add_option("--precision", precision_name,
                 "double, float (search and answer) or mixed (float search, double answer)")
      ->capture_default_str();
  app.add_option("--out", out_file, "CSV: id,distance,lower,px,py,pz,qx,qy,qz,fell_back")->required();
  app.add_flag("--check", check, "exit 1 where the distance is off by more than tolerance x S");
  app.add_option("--tolerance", tolerance, "in S = max(longest edge, largest coordinate)")->capture_default_str();
  app.name("closest");
  if (const auto code = exit_code_of_parsing(app, argc, argv)) return *code;
  try {
    const Kernel& kernel = kernel_named(kernel_name, precision_name);
    const std::vector<Pair> pairs = read_pairs(pair_file, check);
    std::vector<Closest> answers;
    answers.reserve(pairs.size());
    for (const Pair& pair : pairs) answers.push_back(solve(pair, kernel));
    write_answers(answers, out_file);
    return !check || check_answers(pairs, answers, tolerance) ? 0 : 1;
  } catch (const InputError& e) {
    std::cerr << e.what() << '\n';
    return 3;
  }
}
