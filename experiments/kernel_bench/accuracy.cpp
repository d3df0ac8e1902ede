#include "experiments/kernel_bench/accuracy.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace trigrain {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// What an answer may be off by before it is called wrong, in S.
double bar(std::string_view precision) { return precision == "float" ? 1e-6 : 1e-13; }

void set_quantiles(Accuracy& accuracy, std::vector<double>& errors) {
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double share) { return errors[static_cast<std::size_t>(share * (errors.size() - 1))]; };
  accuracy.p50 = at(.5), accuracy.p90 = at(.9), accuracy.p99 = at(.99), accuracy.worst = errors.back();
}

Hits answers(const TrianglePass& pass, const Problem& problem) {
  Hits hits;
  KernelCounts counts;
  pass(0, problem.size(), hits, counts);
  if (hits.size() != problem.size()) throw InputError("a contestant did not answer for every pair. This is a bug.");
  return hits;
}

Query without_reach(Query query) {
  query.reach = infinite;
  return query;
}

} // namespace

Accuracy triangle_accuracy(const Contestant& contestant, const Problem& problem, const Query& query) {
  const Hits hits = answers(contestant.on_triangles(problem, without_reach(query)), problem);
  const double allowed = std::max(query.tolerance, bar(contestant.precision)), share = 1. / problem.size();
  Accuracy accuracy;
  std::vector<double> errors;
  for (int k = 0; k < problem.size(); ++k) {
    const Closest c = hits[k].closest;
    const double s = problem.scale[k], d = static_cast<double>(problem.distance[k]);
    const double off = static_cast<double>(oracle::Quad(c.distance) - problem.distance[k]);
    const double error = std::isfinite(c.distance) ? std::fabs(off) / s : infinite;
    const bool flagged = c.upper - c.lower > allowed * s;
    errors.push_back(error);
    accuracy.wrong += share * (!(error <= bar(contestant.precision)) || (c.distance == 0) != (d == 0));
    accuracy.flagged += share * flagged;
    // a library that gives no bounds flags nothing
    accuracy.wrong_unflagged += share * (!(error <= allowed) && (!flagged || !std::isfinite(c.upper)));
    accuracy.contacts += share * (c.distance <= query.reach);
    accuracy.fell_back += share * c.fell_back;
    if (!contestant.kernel) continue;
    // A hybrid that was asked for less than its bar answers so far off, and does not tell touching from almost
    // touching.
    const Kernel& kernel = *contestant.kernel;
    const bool loose = kernel.name.starts_with("hybrid") && query.tolerance > tolerance_of(kernel);
    Verdict v = judged(c, problem.pairs[k], problem.distance[k], loose ? query.tolerance : tolerance_of(kernel),
                       finds_distance(kernel) && !loose);
    if (loose && v.fault.empty() && !(error <= query.tolerance)) v.fault = "further off than the tolerance asked for";
    if (v.fault.empty()) continue;
    if (accuracy.faults == 0) accuracy.first_fault = v.fault;
    accuracy.faults += share;
  }
  set_quantiles(accuracy, errors);
  return accuracy;
}

Convergence convergence(const Kernel& kernel, const Problem& problem, const Query& query) {
  Convergence result;
  const double allowed = std::max(query.tolerance, bar(kernel.precision)), share = 1. / problem.size();
  std::vector<bool> proven(problem.size());
  Hits before;
  for (int steps = 0; steps <= std::max(most_steps, query.steps); ++steps) {
    Query so_far = without_reach(query);
    so_far.steps = steps;
    Hits hits;
    KernelCounts counts;
    kernel.closest(problem.pair_list(), so_far, hits, counts);
    for (int k = 0; k < problem.size(); ++k) {
      const Closest c = hits[k].closest;
      const double s = problem.scale[k];
      if (steps <= most_steps && !proven[k] && c.upper - c.lower <= allowed * s) {
        proven[k] = true;
        result.proven[steps] += share;
      }
      if (steps != query.steps || steps == 0) continue;
      const Closest last = before[k].closest;
      const Vec3<double> dp = c.p - last.p, dq = c.q - last.q;
      if (std::sqrt(std::max(dot(dp, dp), dot(dq, dq))) > allowed * s) continue;
      result.believed += share;
      result.believed_wrong +=
          share * !(std::fabs(c.distance - static_cast<double>(problem.distance[k])) <= allowed * s);
    }
    before = std::move(hits);
  }
  return result;
}

namespace {

using ContactSet = std::set<std::pair<int, int>>;
struct MeshAnswer {
  ContactSet contacts;
  double distance = infinite;
};

MeshAnswer mesh_answer(const MeshPass& pass, int k) {
  Hits hits;
  KernelCounts counts;
  pass(k, hits, counts);
  MeshAnswer answer;
  for (int h = 0; h < hits.size(); ++h) {
    answer.contacts.insert({hits[h].i, hits[h].j});
    answer.distance = std::min(answer.distance, hits[h].closest.distance);
  }
  return answer;
}

/// As mesh_answer(), with the numbers of B's triangles in their mesh instead of their place among the candidates.
MeshAnswer our_mesh_answer(const Kernel& kernel, const MeshProblem& problem, int k, const Query& query,
                           const Precheck& precheck) {
  const MeshPair& pair = problem.pairs[k];
  Candidates candidates;
  precheck.pairs({pair.a->triangles.view(), &pair.a->octree}, {pair.b->triangles.view(), &pair.b->octree},
                 pair.placement(), problem.reach, candidates);
  Query within = query;
  within.reach = problem.reach;
  Hits hits;
  KernelCounts counts;
  kernel.closest({pair.a->triangles.view(), candidates.b.view(), candidates.pairs}, within, hits, counts);
  MeshAnswer answer;
  for (int h = 0; h < hits.size(); ++h) {
    answer.contacts.insert({hits[h].i, candidates.number_b[hits[h].j]});
    answer.distance = std::min(answer.distance, hits[h].closest.distance);
  }
  return answer;
}

} // namespace

Accuracy mesh_accuracy(const Contestant& contestant, const MeshProblem& problem, const Query& query,
                       const Precheck& precheck) {
  const bool large = problem.meshes[0]->triangles.size() > 1500;
  const Precheck& other = row_named(prechecks(), "pre-check", large ? "box" : "none");
  const MeshPass pass = contestant.on_meshes(problem, query, precheck);
  const double share = 1. / problem.size();
  Accuracy accuracy{.recall = 0};
  std::vector<double> errors;
  for (int k = 0; k < problem.size(); ++k) {
    const MeshAnswer truth = our_mesh_answer(kernel_named("brute-simd"), problem, k, query, other);
    const MeshAnswer found =
        contestant.kernel ? our_mesh_answer(*contestant.kernel, problem, k, query, precheck) : mesh_answer(pass, k);
    const double s = 3 * problem.meshes[0]->radius;
    const double error = found.distance == truth.distance ? 0 : std::fabs(found.distance - truth.distance) / s;
    errors.push_back(error);
    accuracy.contacts += share * static_cast<double>(found.contacts.size());
    const bool wrong = contestant.kernel ? found.contacts != truth.contacts : !(error <= 1e-9);
    accuracy.wrong += share * wrong;
    std::size_t both = 0;
    for (const auto& contact : found.contacts) both += truth.contacts.contains(contact);
    accuracy.recall += share * (truth.contacts.empty() ? 1. : static_cast<double>(both) / truth.contacts.size());
    if (contestant.kernel && contestant.kernel->exact && wrong) {
      if (accuracy.faults == 0)
        accuracy.first_fault = std::to_string(found.contacts.size()) + " contacts instead of " +
                               std::to_string(truth.contacts.size()) + " in mesh pair " + std::to_string(k);
      accuracy.faults += share;
    }
  }
  set_quantiles(accuracy, errors);
  accuracy.wrong_unflagged = accuracy.wrong;
  return accuracy;
}

} // namespace trigrain
