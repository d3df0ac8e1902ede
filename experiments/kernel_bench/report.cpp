#include "experiments/kernel_bench/report.hpp"
#include "experiments/kernel_bench/peak.hpp"
#include "experiments/kernel_bench/problems.hpp"
#include "experiments/machine.hpp"
#include "experiments/record.hpp"
#include "experiments/run_point.hpp"
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

namespace trigrain {
namespace {

using Json = nlohmann::ordered_json;

/// The machine's limits, measured once per program, precision and size of the input.
struct Limits {
  double peak, bandwidth; ///< flop/s, bytes/s
};
const Limits& limits(const std::string& precision, double bytes) {
  static std::map<std::pair<std::string, double>, Limits> known;
  const auto [at, is_new] = known.try_emplace({precision, bytes});
  if (is_new) at->second = {measured_peak_flops(precision), measured_bandwidth(bytes)};
  return at->second;
}

Json params(const BenchOptions& o, const Entry& entry) {
  const bool meshes = entry.meshes != nullptr, ours = entry.contestant->kernel != nullptr;
  const auto finite = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  return {{"kernel", entry.contestant->name},
          {"precision", entry.contestant->precision},
          {"lanes", entry.contestant->lanes},
          {"family", entry.family.name},
          {"precheck", meshes && ours ? Json(entry.precheck->name) : Json(nullptr)},
          {"cuts", meshes && ours ? Json(o.cuts) : Json(nullptr)},
          {"steps", o.query.steps},
          {"tolerance", o.query.tolerance},
          {"batch", o.query.batch},
          {"schedule", o.schedule},
          {"reach_m", meshes ? Json(entry.meshes->reach) : finite(o.query.reach)},
          {"pairs", entry.pairs()},
          {"seed", o.seed},
          {"repeats", o.repeats}};
}

Json check(const Entry& entry) {
  const Accuracy& a = entry.findings().accuracy;
  const std::string detail =
      a.faults > 0 ? a.first_fault
      : entry.contestant->kernel
          ? std::to_string(entry.pairs()) + " answers meet its bars"
          : std::to_string(a.wrong) + " of " + std::to_string(entry.pairs()) + " answers are wrong: a result, no fault";
  return {{"passed", a.faults == 0}, {"how", {{{"what", "answers"}, {"passed", a.faults == 0}, {"detail", detail}}}}};
}

} // namespace

std::vector<std::pair<std::string, double>> Findings::numbers(const Entry& entry) const {
  std::vector<std::pair<std::string, double>> list{
      {"error_p50_S", accuracy.p50},          {"error_p90_S", accuracy.p90},
      {"error_p99_S", accuracy.p99},          {"error_max_S", accuracy.worst},
      {"wrong_share", accuracy.wrong},        {"wrong_unflagged_share", accuracy.wrong_unflagged},
      {"flagged_share", accuracy.flagged},    {"contacts_per_pair", accuracy.contacts},
      {"fall_back_share", accuracy.fell_back}};
  if (const Kernel* kernel = entry.contestant->kernel; kernel && entry.triangles) {
    const auto& [peak, bandwidth] = limits(entry.contestant->precision == "double" ? "double" : "float",
                                           static_cast<double>(entry.pairs()) * kernel->bytes_per_pair);
    list.insert(list.end(), {{"flops_per_pair", kernel->flops_per_pair},
                             {"bytes_per_pair", kernel->bytes_per_pair},
                             {"peak_flop_s", peak},
                             {"bandwidth_B_s", bandwidth},
                             {"roofline_ns_per_pair",
                              1e9 * std::max(kernel->flops_per_pair / peak, kernel->bytes_per_pair / bandwidth)}});
  }
  if (entry.meshes) {
    list.emplace_back("recall", accuracy.recall);
    list.emplace_back("triangles_per_mesh", entry.meshes->meshes[0]->triangles.size());
    if (entry.family.name.starts_with("spheres")) list.emplace_back("gap_error_radii", smooth_gap_error(*entry.meshes));
  }
  if (convergence) {
    list.emplace_back("believed_share", convergence->believed);
    list.emplace_back("believed_wrong_share", convergence->believed_wrong);
  }
  return list;
}

Json bench_record(const BenchOptions& options, const Entry& entry, const std::vector<BenchSample>& samples) {
  Json timed = Json::array(), found{{"flops_per_pair", nullptr}, {"bytes_per_pair", nullptr}};
  const auto load = load_average();
  for (const BenchSample& s : samples)
    timed.push_back({{"wall_s", s.wall},
                     {"cpu_s", s.cpu},
                     {"pairs", s.passes * entry.pairs()},
                     {"load_average_1min", load ? Json(*load) : Json(nullptr)}});
  for (const auto& [name, value] : entry.findings().numbers(entry))
    found[name] = std::isfinite(value) ? Json(value) : Json(nullptr);
  if (const auto& convergence = entry.findings().convergence) found["proven_after_steps"] = convergence->proven;
  return {{"schema", "trigrain-record-1"},
          {"point_id", options.point_id},
          {"status", "finished"},
          {"started_utc", utc_now()},
          {"params", params(options, entry)},
          {"build", describe_build()},
          {"machine", describe_machine()},
          {"check", check(entry)},
          {"samples", std::move(timed)},
          {"kernel", std::move(found)},
          {"warnings", Json::array()}};
}

} // namespace trigrain
