// One point of a study of accuracy or stability: reads the command line, runs it, and writes the record.
#include "dem/contact_rule.hpp"
#include "experiments/atomic_file.hpp"
#include "experiments/record.hpp"
#include "experiments/stability/study.hpp"
#include "kernels/name_table.hpp"
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

int main(int argc, char** argv) {
  using namespace trigrain;
  CLI::App app("Runs one study", "stability");
  std::string name;
  StudyRequest r;
  app.add_option("--study", name)->required();
  app.add_option("--contact-rule", r.contact_rule);
  app.add_option("--value", r.value);
  app.add_option("--level", r.level);
  app.add_option("--steps-per-contact", r.steps_per_contact);
  CLI11_PARSE(app, argc, argv);
  for (const Metric& m : row_named(studies(), "study", name).run(r))
    std::printf("%-28s %12.5g  %s\n", m.name.c_str(), m.value, !m.bar ? "" : m.within() ? "within" : "OUT");
}
