#include "experiments/command_line.hpp"
#include "dem/grid_kind.hpp"
#include "dem/narrow_phase.hpp"
#include "dem/runtime.hpp"
#include "dem/scheme.hpp"
#include "dem/step_size.hpp"
#include "experiments/final_state.hpp"
#include "experiments/option_checks.hpp"
#include "kernels/kernels.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

namespace trigrain {
namespace {

using Json = nlohmann::ordered_json;

/// A row of each name: the engine takes kernels in double, as wide as they come.
template <class Table> void list(std::ostream& out, const char* title, const Table& table) {
  out << title << '\n';
  std::string_view last;
  for (const auto& row : table)
    if (row.name != last) out << "  " << (last = row.name) << ": " << row.about << '\n';
}

void list_all(std::ostream& out) {
  list(out, "scenes", scenes());
  list(out, "kernels", kernels());
  list(out, "prechecks", prechecks());
  list(out, "grids", grid_kinds());
  list(out, "contact rules", contact_rules());
  list(out, "schemes", schemes());
  list(out, "runtimes", runtimes());
  list(out, "step controls", step_controls());
}

void add_scene_options(CLI::App& app, BenchRequest& r) {
  SceneOptions& s = r.scene_options;
  auto* file = app.add_option("--scene-file", r.scene_file, "scene from a JSON file (experiments/schema/scene.json)");
  const auto built_in = [&](CLI::Option* option) { return option->excludes(file)->group("Built-in scene"); };
  built_in(app.add_option("--scene", r.scene, "scene by name, see --list"));
  built_in(app.add_option("--particles", s.particles, "bodies that move"))->check(above_zero);
  built_in(app.add_option("--vertices", s.vertices, "points per granulate, 0 for spheres"))->check(not_negative);
  built_in(app.add_option("--seed", s.seed, "of shapes and places"));
  built_in(app.add_option("--halo", s.halo, "relative: 5 % of the radius; published: 1 mm"));
  built_in(app.add_option("--size-ratio", s.size_ratio, "largest over smallest diameter"))->check(above_zero);
  built_in(app.add_option("--fill", s.fill, "of the gas: largest diameter over the spacing of its lattice"))
      ->check(above_zero);
  built_in(app.add_option("--gravity", s.gravity, "of the gas, downwards (m/s2)"))->check(not_negative);
  app.add_option("--start-state", r.start_state, "final state of the same scene to start from");
}

void add_engine_options(CLI::App& app, BenchRequest& r) {
  const auto engine = [](CLI::Option* option) { return option->group("Engine"); };
  engine(app.add_option("--kernel", r.options.kernel));
  engine(app.add_option("--precheck", r.options.precheck));
  engine(app.add_option("--grid", r.options.grid));
  engine(app.add_option("--contact-rule", r.options.contact_rule));
  engine(app.add_option("--scheme", r.options.scheme));
  engine(app.add_option("--runtime", r.options.runtime));
  engine(app.add_option("--layers", r.options.layers, "what is shared out: grid, particle, triangle, joined by +"));
  engine(app.add_option("--threads", r.options.threads))->check(above_zero);
  engine(app.add_option("--subdivision", r.options.subdivision, "a grid cell splits into k^3"))->check(above_zero);
  engine(app.add_option("--skin", r.options.skin,
                        "keep the grid's pairs until a body has moved so far, in diameters of the smallest body"))
      ->check(not_negative);
  engine(
      app.add_option("--triangle-search", r.options.triangle_search,
                     "of meshes: every-step, or when-needed, which keeps what is near for the steps that follow"));
  engine(app.add_option("--step-control", r.step_control, "how the time step follows contacts; default: the scene's"));
}

void add_run_options(CLI::App& app, BenchRequest& r) {
  const auto run = [](CLI::Option* option) { return option->group("Run"); };
  auto* steps = run(app.add_option("--steps", r.steps, "length of a sample"))->check(above_zero);
  run(app.add_option("--end", r.end, "length of a sample in simulated seconds; default: the scene's"))
      ->check(above_zero)
      ->excludes(steps);
  run(app.add_option("--repeats", r.repeats, "samples, each from the same start"))->check(above_zero);
  run(app.add_option("--warmup", r.warmup, "untimed steps before each sample"))->check(not_negative);
  run(app.add_option("--check-steps", r.check_steps, "steps of the check before the timing; default: at most 20"))
      ->check(above_zero);

  const auto output = [](CLI::Option* option) { return option->group("Output"); };
  output(app.add_option("--record", r.record, "JSON of all that was run, checked and measured"));
  output(app.add_option("--history", r.history, "add a row to the record's history for every so many steps"))
      ->check(above_zero);
  output(app.add_option("--point-id", r.point_id, "name of this point of a sweep"));
  output(app.add_option("--param", r.extra_params, "key=value, copied into the record's params; may be repeated"))
      ->allow_extra_args(false);
  output(app.add_option("--final-state", r.final_state, "JSON of where the bodies ended"));
  output(app.add_option("--hand-over", r.hand_over,
                        "JSON of the bodies there with shapes and masses, for other programs"));
  output(app.add_option("--trace", r.trace, "every piece of work of every thread, in Chrome's trace format"));
  auto* vtk = output(app.add_option("--vtk", r.vtk,
                                    "folder for ParaView: frames.pvd with the bodies, grid.pvd with the grid's cells"));
  output(app.add_option("--vtk-every", r.vtk_every, "simulated seconds between frames; default: first and last only"))
      ->check(above_zero)
      ->needs(vtk);
}

/// A number, true or false as such, everything else as text.
Json value_of(const std::string& text) {
  const Json value = Json::parse(text, nullptr, false);
  return value.is_number() || value.is_boolean() ? value : Json(text);
}

} // namespace

std::optional<BenchRequest> parse_command_line(int argc, const char* const* argv, std::ostream& out) {
  BenchRequest request;
  bool wants_list = false;
  CLI::App app("Runs one point of an experiment: checks the answers, then times them.", "dem_bench");
  app.add_flag("--list", wants_list, "every name of every table with what it means, and stop");
  add_scene_options(app, request);
  add_engine_options(app, request);
  add_run_options(app, request);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    out << app.help();
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw command_line_error(app, error);
  }
  for (const double seconds : {request.end.value_or(1), request.vtk_every})
    if (!std::isfinite(seconds)) throw InputError("a time is not a finite number (--end, --vtk-every). Give seconds.");
  if (wants_list) {
    list_all(out);
    return std::nullopt;
  }
  if (request.scene.empty() && request.scene_file.empty())
    throw InputError("no scene (command line). Give --scene NAME, one of " + names_of(scenes()) +
                     ", or --scene-file FILE.");
  if (request.point_id.empty()) request.point_id = request.record.empty() ? "unnamed" : request.record.stem().string();
  return request;
}

Json params_of(const BenchRequest& r) {
  const bool built_in = r.scene_file.empty();
  const auto if_built_in = [&](const auto& value) { return built_in ? Json(value) : Json(nullptr); };
  const auto or_null = [](const auto& value) { return value ? Json(*value) : Json(nullptr); };
  const auto path = [](const std::filesystem::path& p) { return p.empty() ? Json(nullptr) : Json(p.string()); };
  Json params = {{"scene", if_built_in(r.scene)},
                 {"scene_file", path(r.scene_file)},
                 {"particles", if_built_in(r.scene_options.particles)},
                 {"vertices", if_built_in(r.scene_options.vertices)},
                 {"seed", if_built_in(r.scene_options.seed)},
                 {"halo", if_built_in(r.scene_options.halo)},
                 {"size_ratio", if_built_in(r.scene_options.size_ratio)},
                 {"fill", if_built_in(r.scene_options.fill)},
                 {"gravity", if_built_in(r.scene_options.gravity)},
                 {"start_state", path(r.start_state)},
                 {"kernel", r.options.kernel},
                 {"precheck", r.options.precheck},
                 {"grid", r.options.grid},
                 {"contact_rule", r.options.contact_rule},
                 {"scheme", r.options.scheme},
                 {"runtime", r.options.runtime},
                 {"layers", r.options.layers},
                 {"threads", r.options.threads},
                 {"subdivision", r.options.subdivision},
                 {"skin", r.options.skin},
                 {"triangle_search", r.options.triangle_search},
                 {"step_control", r.step_control.empty() ? Json(nullptr) : Json(r.step_control)},
                 {"steps", or_null(r.steps)},
                 {"end_s", or_null(r.end)},
                 {"repeats", r.repeats},
                 {"warmup_steps", r.warmup},
                 {"check_steps", or_null(r.check_steps)}};
  for (const std::string& text : r.extra_params) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InputError("cannot read '" + text + "' (--param). Write key=value.");
    const std::string key = text.substr(0, equals);
    const Json value = value_of(text.substr(equals + 1));
    if (params.contains(key) && params[key] != value)
      throw InputError("the parameter '" + key + "' has another value already (--param). Use a name of its own.");
    params[key] = value;
  }
  return params;
}

StartingPoint starting_point(const BenchRequest& request) {
  Scene scene =
      request.scene_file.empty() ? make_scene(request.scene, request.scene_options) : load_scene(request.scene_file);
  if (!request.step_control.empty())
    scene.time.control = row_named(step_controls(), "step control", request.step_control).name;
  if (request.start_state.empty()) return {std::move(scene), 0};
  const FinalState state = read_final_state(request.start_state);
  return {continued(std::move(scene), state, request.start_state), state.time};
}

} // namespace trigrain
