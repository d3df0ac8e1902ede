#include "experiments/kernel_bench/options.hpp"
#include "experiments/atomic_file.hpp"
#include "experiments/option_checks.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <map>
#include <ostream>

namespace trigrain {
namespace {

/// Rows of one name are named once.
template <class Table> void list_names(std::ostream& out, const char* title, const Table& table) {
  out << title << '\n';
  std::string last;
  for (const auto& row : table) {
    if (row.name != last) out << "  " << row.name << ": " << row.about << '\n';
    last = row.name;
  }
}

void print_list(std::ostream& out) {
  list_names(out, "kernels", contestants());
  list_names(out, "families", bench_families());
  list_names(out, "prechecks", prechecks());
  list_names(out, "schedules", penalty_schedules());
}

bool wanted(const std::string& choice, const std::string& name) { return choice == "all" || choice == name; }

bool wanted_width(const BenchOptions& options, const Contestant& c) {
  if (!c.kernel || options.lanes == c.lanes) return true;
  return options.lanes == 0 && &kernel_named(c.name, c.precision) == c.kernel;
}

} // namespace

std::optional<BenchOptions> parse_bench_options(int argc, char** argv, std::ostream& out) {
  BenchOptions o;
  bool list = false;
  CLI::App app{"Checks, then times kernels and peers. Without --record: a table; names may be 'all'. Options of Google "
               "Benchmark\n(--benchmark_enable_random_interleaving=true, ...) are passed on. Exit codes: 0 fine, 1 a "
               "check failed, 3 usage."};
  app.set_help_flag("-h,--help", "print this");
  app.add_flag("--list", list, "names of kernels, families, pre-checks and schedules");
  app.add_option("--kernel", o.kernel, "kernel or peer")->capture_default_str();
  app.add_option("--precision", o.precision, "double, float, mixed or all; peers have one of their own")
      ->capture_default_str();
  app.add_option("--lanes", o.lanes, "pairs at once; 0 for as many as fill a register")->capture_default_str();
  app.add_option("--family", o.family, "what the pairs are like; see --list")->capture_default_str();
  app.add_option("--precheck", o.precheck, "of meshes")->capture_default_str();
  app.add_option("--cuts", o.cuts, "of the octrees of meshes: as deep as each cube needs, or all as deep as one needs")
      ->check(CLI::IsMember({"adaptive", "regular"}))
      ->capture_default_str();
  app.add_option("--steps", o.query.steps, "Newton steps")->check(CLI::Range(0, 64))->capture_default_str();
  app.add_option("--tolerance", o.query.tolerance, "in S, of a hybrid's proof")->check(not_negative);
  app.add_option("--batch", o.query.batch, "pairs proven or redone together")->check(above_zero);
  app.add_option("--schedule", o.schedule, "constants of the penalty method")->capture_default_str();
  app.add_option("--reach", o.query.reach, "contacts at most so far apart (m), of triangle pairs")->check(not_negative);
  app.add_option("--pairs", o.pairs, "default: 10000 of triangles, 100 of meshes")->check(above_zero);
  app.add_option("--seed", o.seed, "of the pairs")->capture_default_str();
  app.add_option("--repeats", o.repeats, "samples")->check(above_zero)->capture_default_str();
  app.add_option("--seconds", o.seconds, "length of a sample, at least")->check(above_zero);
  app.add_option("--record", o.record, "write the record of one contestant on one family");
  app.add_option("--point-id", o.point_id, "name of the point in the record");
  app.allow_extras();
  app.name("kernel_bench");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    out << app.help();
    return {};
  } catch (const CLI::ParseError& e) {
    throw command_line_error(app, e);
  }
  if (list) {
    print_list(out);
    return {};
  }
  o.benchmark_arguments = app.remaining();
  for (const std::string& extra : o.benchmark_arguments)
    if (!extra.starts_with("--benchmark_"))
      throw InputError("unknown option '" + extra + "' (command line). See kernel_bench --help.");
  o.query.schedule = &row_named(penalty_schedules(), "schedule", o.schedule);
  row_named(prechecks(), "pre-check", o.precheck);
  if (o.kernel != "all") row_named(contestants(), "kernel", o.kernel);
  if (o.family != "all") row_named(bench_families(), "family", o.family);
  if (!o.record.empty()) require_writable(o.record);
  return o;
}

std::string Entry::name() const {
  std::string text =
      contestant->name + '/' + contestant->precision + '/' + std::to_string(contestant->lanes) + '/' + family.name;
  return meshes && contestant->kernel ? text + '/' + std::string(precheck->name) : text;
}

BenchPass Entry::pass() const {
  if (triangles)
    return [pass = contestant->on_triangles(*triangles, options->query),
            size = triangles->size()](Hits& hits, KernelCounts& counts) {
      constexpr int block = 512; // answers are used while they are in the cache, as a step does
      for (int first = 0; first < size; first += block) {
        hits.clear();
        pass(first, std::min(block, size - first), hits, counts);
      }
    };
  return [pass = contestant->on_meshes(*meshes, options->query, *precheck),
          size = meshes->size()](Hits& hits, KernelCounts& counts) {
    for (int k = 0; k < size; ++k) {
      hits.clear();
      pass(k, hits, counts);
    }
  };
}

const Findings& Entry::findings() const {
  if (found) return *found;
  auto seen = std::make_shared<Findings>();
  if (triangles) {
    seen->accuracy = triangle_accuracy(*contestant, *triangles, options->query);
    if (contestant->name == "iterative")
      seen->convergence = convergence(*contestant->kernel, *triangles, options->query);
  } else {
    seen->accuracy = mesh_accuracy(*contestant, *meshes, options->query, *precheck);
  }
  found = seen;
  return *found;
}

std::vector<Entry> chosen_entries(const BenchOptions& options, const std::vector<Contestant>& contestants) {
  constexpr int triangle_pairs = 10000, mesh_pairs = 100;
  std::vector<Entry> entries;
  for (const BenchFamily& family : bench_families()) {
    if (!wanted(options.family, family.name)) continue;
    std::shared_ptr<const Problem> triangles; // made once for all contestants
    std::shared_ptr<const MeshProblem> meshes;
    for (const Contestant& c : contestants) {
      const bool answers = family.meshes ? static_cast<bool>(c.on_meshes) : static_cast<bool>(c.on_triangles);
      if (!answers || !wanted(options.kernel, c.name) || !wanted_width(options, c)) continue;
      if (c.kernel && !wanted(options.precision, c.precision)) continue;
      if (family.meshes && !meshes)
        meshes = std::make_shared<MeshProblem>(
            mesh_problem(family, options.seed, options.pairs > 0 ? options.pairs : mesh_pairs,
                         options.cuts == "regular" ? Cuts::regular : Cuts::adaptive));
      if (!family.meshes && !triangles)
        triangles = std::make_shared<Problem>(
            triangle_problem(family, options.seed, options.pairs > 0 ? options.pairs : triangle_pairs));
      entries.push_back(
          {&c, family, &options, &row_named(prechecks(), "pre-check", options.precheck), triangles, meshes});
    }
  }
  if (entries.empty())
    throw InputError("no contestant '" + options.kernel + "' in precision '" + options.precision + "' with " +
                     std::to_string(options.lanes) + " lanes on '" + options.family + "' (command line). See --list.");
  if (!options.record.empty() && entries.size() != 1)
    throw InputError(std::to_string(entries.size()) +
                     " contestants for one record (--record). Name one --kernel, --precision and --family.");
  return entries;
}

} // namespace trigrain
