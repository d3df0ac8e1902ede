#include "kernels/proof/proof.hpp"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace trigrain {

Problem problem(const std::vector<Pair>& pairs) {
  Problem p{.pairs = pairs, .distance = {}, .scale = {}, .a = {}, .b = {}, .list = {}};
  for (int k = 0; k < p.size(); ++k) {
    const Pair& pair = pairs[k];
    p.distance.push_back(oracle::distance(pair.a, pair.b));
    p.scale.push_back(scale(pair));
    p.a.push_back(pair.a);
    p.b.push_back(pair.b);
    p.list.push_back({k, k});
  }
  return p;
}

Problem problem(const RandomFamily& family, std::uint64_t first, int count) {
  std::vector<Pair> pairs;
  for (int k = 0; k < count; ++k) pairs.push_back(random_pair(family, first + k));
  return problem(pairs);
}

double tolerance_of(const Kernel& kernel) { return kernel.precision == "float" ? 5.4e-6 : 1e-14; }
bool finds_distance(const Kernel& kernel) { return kernel.name != "iterative"; }

double distance_from(const Vec3<double>& p, const Triangle& t, double good_enough) {
  // Points of t, so each distance is an upper bound: the foot on the plane, projected twice, then those on the edges.
  using Real = long double;
  using Vector = Vec3<Real>;
  const auto wide = [](const Vec3<double>& x) { return Vector{x.x, x.y, x.z}; };
  const Vector r = wide(p) - wide(t.a0), e = wide(t.a1) - wide(t.a0), f = wide(t.a2) - wide(t.a0), n = cross(e, f);
  Real d2 = dot(r, r);
  const auto clamped = [](Real x) { return std::clamp(x, Real(0), Real(1)); };
  const auto try_edge = [&](const Vector& from, const Vector& u) {
    const Real uu = dot(u, u);
    const Vector rest = from - (uu > 0 ? clamped(dot(from, u) / uu) : Real(0)) * u;
    d2 = std::min(d2, dot(rest, rest));
  };
  try_edge(r, e);
  try_edge(r, f);
  try_edge(r - e, f - e);
  if (const Real nn = dot(n, n); nn > 0) {
    Real v = 0, w = 0;
    for (int pass = 0; pass < 2; ++pass) {
      const Vector rest = r - v * e - w * f;
      v = clamped(v + dot(cross(rest, f), n) / nn);
      w = std::clamp(w + dot(cross(e, rest), n) / nn, Real(0), 1 - v);
    }
    const Vector rest = r - v * e - w * f;
    d2 = std::min(d2, dot(rest, rest));
  }
  const double found = static_cast<double>(std::sqrt(d2));
  return found <= good_enough ? found : static_cast<double>(oracle::distance(p, t));
}

Verdict judged(const Closest& c, const Pair& pair, const oracle::Quad& distance, double tolerance,
               bool finds_distance) {
  const double s = scale(pair), least = std::numeric_limits<double>::denorm_min();
  for (const double x : {c.distance, c.upper, c.lower, c.p.x, c.p.y, c.p.z, c.q.x, c.q.y, c.q.z})
    if (!std::isfinite(x)) return {{}, "not finite"};
  const auto in_units = [&](double x) { return x / std::max(s, least); };
  const double error = static_cast<double>(oracle::Quad(c.distance) - distance);
  const double apart = std::sqrt(dot(c.p - c.q, c.p - c.q));
  const double off = std::max(distance_from(c.p, pair.a, tolerance * s), distance_from(c.q, pair.b, tolerance * s));
  Verdict v{{in_units(std::fabs(error)), in_units(off), in_units(std::fabs(apart - c.distance))}, ""};
  const auto fault = [&](const char* what, double by) {
    std::ostringstream text;
    text << what << ' ' << by << " S";
    v.fault = text.str();
    return v;
  };
  if (c.lower < 0) return fault("negative lower bound", in_units(c.lower));
  if (c.lower > distance) return fault("lower bound too high by", in_units(static_cast<double>(c.lower - distance)));
  if (c.upper < distance) return fault("upper bound too low by", in_units(static_cast<double>(distance - c.upper)));
  if (off > tolerance * s) return fault("a point off its triangle by", in_units(off));
  if (v.deviation.apart > tolerance) return fault("|p - q| off the distance by", v.deviation.apart);
  if (!finds_distance) return v;
  if (v.deviation.distance > tolerance) return fault("distance wrong by", in_units(error));
  if (c.distance == 0 && distance != 0) return fault("false zero, distance", in_units(static_cast<double>(distance)));
  if (c.distance != 0 && distance == 0) return fault("missed zero, distance", in_units(c.distance));
  return v;
}

namespace {

Triangle scaled(const Triangle& t, double f) { return {f * t.a0, f * t.a1, f * t.a2}; }

std::vector<Closest> answers(const Kernel& kernel, const PairList& list) {
  Hits hits;
  KernelCounts counts;
  kernel.closest(list, {}, hits, counts);
  std::vector<Closest> answers;
  for (int k = 0; k < hits.size(); ++k) answers.push_back(hits[k].closest);
  if (static_cast<int>(answers.size()) != list.size())
    throw std::runtime_error(std::string(kernel.name) + " did not answer for every pair");
  return answers;
}

bool same(const Closest& x, const Closest& y, double f) {
  return f * x.distance == y.distance && f * x.lower == y.lower && f * x.upper == y.upper && f * x.p.x == y.p.x &&
         f * x.p.y == y.p.y && f * x.p.z == y.p.z && f * x.q.x == y.q.x && f * x.q.y == y.q.y && f * x.q.z == y.q.z &&
         x.feature == y.feature;
}

bool finds_contact(const Kernel& kernel, const Problem& p, int k, double reach) {
  Hits hits;
  KernelCounts counts;
  kernel.closest({p.a.view(), p.b.view(), std::span(p.list).subspan(k, 1)}, {.reach = reach}, hits, counts);
  return !hits.empty();
}

/// Contacts for reaches at, beside and around the distance. `exact`: that of brute force, which all exact kernels must
/// share; the others may differ within their tolerance.
std::string wrong_contact(const Kernel& kernel, const Problem& p, int k, double exact) {
  if (!finds_distance(kernel)) return "";
  const double slack = kernel.exact ? 0 : tolerance_of(kernel) * p.scale[k];
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  for (const double reach : {0., exact, std::nextafter(exact, 0), std::nextafter(exact, everywhere), .9 * exact,
                             1.1 * exact, 1e-2 * p.scale[k]}) {
    if (std::fabs(reach - exact) < slack) continue;
    if (finds_contact(kernel, p, k, reach) == (exact <= reach)) continue;
    std::ostringstream text;
    text << (exact <= reach ? "contact missed" : "contact invented") << " for a reach of " << std::hexfloat << reach;
    return text.str();
  }
  return "";
}

/// Every third power of the two that random_pair() does not mix in; float squares lengths twice and has less room.
double power_of_two(const Kernel& kernel, std::uint64_t k) {
  const int range = kernel.precision == "float" ? 4 : 40;
  return std::ldexp(1, static_cast<int>(k * 2654435761u % (2 * range + 1)) - range);
}

class Judge {
 public:
  Judge(const Problem& problem, std::uint64_t first)
      : problem_(problem), first_(first), exact_(answers(kernel_named("brute"), problem.pair_list())) {}

  void judge(Tally& tally) const {
    const Kernel& kernel = *tally.kernel;
    const std::vector<Closest> found = answers(kernel, problem_.pair_list()), other = answers_when_scaled(kernel);
    for (int k = 0; k < problem_.size(); ++k) {
      const Verdict v =
          judged(found[k], problem_.pairs[k], problem_.distance[k], tolerance_of(kernel), finds_distance(kernel));
      tally.worst.distance = std::max(tally.worst.distance, v.deviation.distance);
      tally.worst.points = std::max(tally.worst.points, v.deviation.points);
      tally.worst.apart = std::max(tally.worst.apart, v.deviation.apart);
      ++tally.pairs;
      tally.zeros += problem_.distance[k] == 0;
      tally.fell_back += found[k].fell_back;
      std::string fault = v.fault;
      if (fault.empty() && !same(found[k], other[k], power_of_two(kernel, first_ + k)))
        fault = "other bits at another power of two";
      if (fault.empty()) fault = wrong_contact(kernel, problem_, k, exact_[k].distance);
      if (!fault.empty()) add_fault(tally, fault, k);
    }
  }

 private:
  std::vector<Closest> answers_when_scaled(const Kernel& kernel) const {
    Triangles a, b;
    for (int k = 0; k < problem_.size(); ++k) {
      const double f = power_of_two(kernel, first_ + k);
      a.push_back(scaled(problem_.pairs[k].a, f));
      b.push_back(scaled(problem_.pairs[k].b, f));
    }
    return answers(kernel, {a.view(), b.view(), problem_.list});
  }
  void add_fault(Tally& tally, const std::string& fault, int k) const {
    constexpr std::size_t most_examples = 5;
    if (++tally.faults > static_cast<std::int64_t>(most_examples)) return;
    std::ostringstream text;
    text << fault << ", pair " << first_ + k << ": " << problem_.pairs[k];
    tally.examples.push_back(text.str());
  }

  const Problem& problem_;
  std::uint64_t first_;
  std::vector<Closest> exact_;
};

} // namespace

std::vector<Tally> prove(const RandomFamily& family, std::span<const Kernel* const> kernels, std::uint64_t first,
                         int count) {
  std::vector<Tally> tallies;
  for (const Kernel* kernel : kernels) tallies.push_back({.kernel = kernel, .worst = {}, .examples = {}});
  constexpr int block = 500; // ragged: the last pack of a block is not full
  for (int done = 0; done < count; done += block) {
    const Problem p = problem(family, first + done, std::min(block, count - done));
    const Judge judge(p, first + done);
    for (Tally& tally : tallies) judge.judge(tally);
  }
  return tallies;
}

} // namespace trigrain
