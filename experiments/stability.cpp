// One point of a study of accuracy or stability: reads the command line, runs it, and writes the record.
#include "dem/contact_law.hpp"
#include "dem/contact_rule.hpp"
#include "dem/step_size.hpp"
#include "experiments/atomic_file.hpp"
#include "experiments/machine.hpp"
#include "experiments/option_checks.hpp"
#include "experiments/record.hpp"
#include "experiments/stability/study.hpp"
#include "kernels/name_table.hpp"
#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

namespace trigrain {
namespace {

using Json = nlohmann::ordered_json;

struct Request {
  std::string study, point_id = "unnamed";
  std::filesystem::path record;
  StudyRequest options;
  bool list = false;
};

void list_names(const char* title, const auto& table) {
  std::printf("%s\n", title);
  for (const auto& row : table) std::printf("  %s: %s\n", row.name.data(), row.about.data());
}

void list_all() {
  list_names("studies", studies());
  list_names("contact rules", contact_rules());
  list_names("laws", contact_laws());
  list_names("controls", step_controls());
}

Request read(int argc, char** argv, CLI::App& app) {
  Request r;
  app.add_option("--study", r.study, "what is asked, see --list");
  app.add_option("--contact-rule", r.options.contact_rule);
  app.add_option("--law", r.options.law);
  app.add_option("--control", r.options.control, "of the step");
  app.add_option("--value", r.options.value, "the quantity that the study varies");
  app.add_option("--level", r.options.level, "of an icosphere that stands for a ball; -1: a sphere");
  app.add_option("--steps-per-contact", r.options.steps_per_contact)->check(above_zero);
  app.add_option("--stiffness", r.options.stiffness, "times what the study takes by itself")->check(above_zero);
  app.add_option("--particles", r.options.particles, "grains")->check(above_zero);
  app.add_option("--vertices", r.options.vertices, "points of a granulate; 0: spheres")->check(not_negative);
  app.add_option("--seed", r.options.seed);
  app.add_option("--record", r.record, "JSON of what was run and found");
  app.add_option("--point-id", r.point_id, "name of this point of a sweep");
  app.add_flag("--list", r.list, "every name of every table with what it means, and stop");
  app.parse(argc, argv);
  return r;
}

Json record_of(const Request& r, const std::vector<Metric>& metrics, double wall, double cpu,
               const std::string& began) {
  Json found;
  bool finite = true;
  for (const Metric& m : metrics) {
    finite = finite && std::isfinite(m.value);
    found[m.name] = {{"value", std::isfinite(m.value) ? Json(m.value) : Json(nullptr)},
                     {"bar", m.bar ? Json(*m.bar) : Json(nullptr)},
                     {"within", m.bar ? Json(m.within()) : Json(nullptr)}};
  }
  const StudyRequest& o = r.options;
  return {
      {"schema", "trigrain-record-1"},
      {"point_id", r.point_id},
      {"status", "finished"},
      {"started_utc", began},
      {"params",
       {{"study", r.study},
        {"contact_rule", o.contact_rule},
        {"law", o.law},
        {"control", o.control},
        {"value", o.value},
        {"level", o.level},
        {"steps_per_contact", o.steps_per_contact},
        {"stiffness", o.stiffness},
        {"particles", o.particles},
        {"vertices", o.vertices},
        {"seed", o.seed}}},
      {"build", describe_build()},
      {"machine", describe_machine()},
      {"placement", observe_placement("serial", 1)},
      {"check",
       {{"passed", true},
        {"how",
         {{{"what", "answered"},
           {"passed", true},
           {"detail", finite ? "every value is finite" : "some values are not finite: the method failed there"}}}}}},
      {"samples",
       {{{"wall_s", wall},
         {"cpu_s", cpu},
         {"load_average_1min", load_average() ? Json(*load_average()) : Json(nullptr)}}}},
      {"metrics", found},
      {"warnings", Json::array()}};
}

int run(int argc, char** argv) {
  CLI::App app("Runs one study of accuracy or stability.", "stability");
  Request r;
  try {
    r = read(argc, argv, app);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return 0;
  } catch (const CLI::ParseError& error) {
    throw command_line_error(app, error);
  }
  if (r.list) {
    list_all();
    return 0;
  }
  if (!r.record.empty()) require_writable(r.record);
  const Study& study = row_named(studies(), "study", r.study);
  row_named(contact_rules(), "contact rule", r.options.contact_rule);
  const std::string began = utc_now();
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  const std::vector<Metric> metrics = study.run(r.options);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double used = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  for (const Metric& m : metrics)
    std::printf("%-34s %13.6g  %s\n", m.name.c_str(), m.value,
                !m.bar       ? ""
                : m.within() ? "within its bar"
                             : "OUT OF ITS BAR");
  if (!r.record.empty()) write_atomically(r.record, record_of(r, metrics, wall, used, began).dump(1) + "\n");
  return 0;
}

} // namespace
} // namespace trigrain

int main(int argc, char** argv) {
  try {
    return trigrain::run(argc, argv);
  } catch (const trigrain::InputError& error) {
    std::cerr << "stability: " << error.what() << '\n';
    return 3;
  } catch (const std::exception& error) {
    std::cerr << "stability: " << error.what() << '\n';
    return 4;
  }
}
