#include "experiments/record.hpp"
#include "experiments/build_info.hpp"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace trigrain {
namespace {

using Json = nlohmann::ordered_json;

template <class T> Json or_null(const std::optional<T>& value) { return value ? Json(*value) : Json(nullptr); }
Json or_null(std::string_view text) { return text.empty() ? Json(nullptr) : Json(text); }

Json scene_json(const PointResult& point) {
  const Scene& scene = point.scene;
  Particles particles; // knows the masses
  std::int64_t triangles = 0, moving_triangles = 0, moving = 0;
  double mass = 0;
  for (const Body& body : scene.bodies) {
    particles.add(body);
    const std::int64_t count = body.mesh ? body.mesh->triangles.size() : 0;
    triangles += count;
    if (body.fixed) continue;
    moving_triangles += count;
    mass += particles.mass.back();
    ++moving;
  }
  return {{"name", scene.name},
          {"bodies", scene.bodies.size()},
          {"moving_bodies", moving},
          {"triangles", triangles},
          {"mean_triangles_per_particle",
           moving ? static_cast<double>(moving_triangles) / static_cast<double>(moving) : 0.},
          {"stiffness_N_m", scene.contact.stiffness},
          {"damping_ratio", scene.contact.damping_ratio},
          {"friction", scene.contact.friction},
          {"step_s", scene.time.step},
          {"step_control", scene.time.control},
          {"start_time_s", point.start_time},
          {"total_mass_kg", mass}};
}

Json check_json(const Check& check) {
  Json how = Json::array();
  for (const CheckItem& item : check.how)
    how.push_back({{"what", item.what}, {"passed", item.passed}, {"detail", item.detail}});
  return {{"passed", check.passed()}, {"how", std::move(how)}};
}

Json sample_json(const Sample& sample) {
  Json phases;
  for (std::size_t i = 0; i < phase_names.size(); ++i) phases[std::string(phase_names[i])] = sample.stats.seconds[i];
  return {{"wall_s", sample.used.wall},
          {"cpu_s", sample.used.cpu},
          {"steps", sample.stats.steps},
          {"phases_s", std::move(phases)},
          {"search_s", sample.search},
          {"load_average_1min", or_null(sample.load_average)},
          {"steal_s", or_null(sample.used.steal)},
          {"voluntary_context_switches", sample.used.voluntary_switches},
          {"involuntary_context_switches", sample.used.involuntary_switches}};
}

Json counts_json(const StepStats& stats) {
  static_assert(sizeof(StepStats) == sizeof(StepStats::seconds) + 20 * sizeof(std::int64_t),
                "a count is missing below");
  return {{"steps", stats.steps},
          {"candidate_pairs", stats.candidate_pairs},
          {"body_pairs", stats.body_pairs},
          {"searched_pairs", stats.searched_pairs},
          {"triangle_pairs", stats.triangle_pairs},
          {"newton_steps", stats.newton_steps},
          {"fall_backs", stats.fall_backs},
          {"contacts", stats.contacts},
          {"fast_contacts", stats.fast_contacts},
          {"fast_bodies", stats.fast_bodies},
          {"unstable_steps", stats.unstable_steps},
          {"crossings", stats.crossings},
          {"visited_vertices", stats.visited_vertices},
          {"virtual_copies", stats.virtual_copies},
          {"levels", stats.levels},
          {"cells", stats.cells},
          {"refinements", stats.refinements},
          {"coarsenings", stats.coarsenings},
          {"settled_bodies", stats.settled_bodies},
          {"searches", stats.searches}};
}

Json energy_json(const Energy& energy) {
  return {{"kinetic", energy.kinetic}, {"potential", energy.potential}, {"elastic", energy.elastic},
          {"damping", energy.damping}, {"friction", energy.friction},   {"outside", energy.outside}};
}

/// What the run has lost or gained against its own books; null before the first sample.
Json accuracy_json(const Sample& sample) {
  const Energy &first = sample.initial, &last = sample.final;
  const double turned_over = std::max({first.kinetic, last.kinetic, std::abs(last.potential - first.potential),
                                       last.elastic, last.damping + last.friction - first.damping - first.friction});
  const double drift = last.balance() - first.balance();
  return {{"energy_drift_J", drift},
          {"energy_drift_relative", turned_over > 0 ? Json(drift / turned_over) : Json(nullptr)},
          {"momentum_error_kg_m_s", array_of(sample.momentum_error.linear)},
          {"angular_momentum_error_kg_m2_s", array_of(sample.momentum_error.angular)}};
}

Json hash_json(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

} // namespace

Json describe_build() {
  Json libraries;
  for (const auto& [name, version] : build_info.libraries) libraries[std::string(name)] = or_null(version);
  return {{"version", build_info.version},       {"commit", or_null(build_info.commit)},
          {"dirty", build_info.dirty},           {"compiler", build_info.compiler},
          {"flags", build_info.flags},           {"arch", build_info.arch},
          {"build_type", build_info.build_type}, {"arch_resolved", or_null(build_info.arch_resolved)},
          {"libraries", std::move(libraries)}};
}

Json make_record(const PointResult& point, const std::string& point_id) {
  Json samples = Json::array();
  for (const Sample& sample : point.samples) samples.push_back(sample_json(sample));
  const Sample* last = point.samples.empty() ? nullptr : &point.samples.back();
  return {{"schema", "trigrain-record-1"},
          {"point_id", point_id},
          {"status", "finished"},
          {"started_utc", point.started_utc},
          {"params", point.params},
          {"scene", scene_json(point)},
          {"build", describe_build()},
          {"machine", describe_machine()},
          {"placement", point.placement},
          {"check", check_json(point.check)},
          {"samples", std::move(samples)},
          {"counts", last ? counts_json(last->stats) : Json(nullptr)},
          {"energy_J",
           last ? Json{{"initial", energy_json(last->initial)}, {"final", energy_json(last->final)}} : Json(nullptr)},
          {"history", last && last->history ? last->history->to_json() : Json(nullptr)},
          {"heap_bytes", last ? or_null(last->heap_bytes) : Json(nullptr)},
          {"accuracy", last ? accuracy_json(*last) : Json(nullptr)},
          {"state_hash", last ? hash_json(last->state_hash) : Json(nullptr)},
          {"counters", point.counters},
          {"warnings", point.warnings}};
}

} // namespace trigrain
