#include "experiments/command_line.hpp"
#include "kernels/kernels.hpp"
#include "kernels/name_table.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace trigrain {
namespace {

std::optional<BenchRequest> parse(std::vector<const char*> words, std::ostream& out) {
  words.insert(words.begin(), "dem_bench");
  return parse_command_line(static_cast<int>(words.size()), words.data(), out);
}
BenchRequest parse(const std::vector<const char*>& words) {
  std::ostringstream out;
  return parse(words, out).value();
}

TEST(CommandLine, refuses_what_makes_no_sense_and_says_what) {
  struct Case {
    std::vector<const char*> words;
    const char* says;
  };
  const Case cases[] = {
      {{}, "--scene NAME"},
      {{"--scene", "hopper", "--scene-file", "s.json"}, "excludes"},
      {{"--scene-file", "s.json", "--particles", "10"}, "excludes"},
      {{"--scene", "hopper", "--particles", "-5"}, "--particles"},
      {{"--scene", "hopper", "--particles", "many"}, "many"},
      {{"--scene", "hopper", "--vertices", "-1"}, "--vertices"},
      {{"--scene", "hopper", "--threads", "0"}, "--threads"},
      {{"--scene", "hopper", "--steps", "0"}, "--steps"},
      {{"--scene", "hopper", "--steps", "10", "--end", "1"}, "excludes"},
      {{"--scene", "hopper", "--repeats", "0"}, "--repeats"},
      {{"--scene", "hopper", "--warmup", "-1"}, "--warmup"},
      {{"--scene", "hopper", "--vtk-every", "0.1"}, "--vtk"},
      {{"--scene", "hopper", "--no-check"}, "unknown option '--no-check' (command line). See dem_bench --help."},
      {{"--scene", "hopper", "--check-steps", "0"},
       "--check-steps: a number above 0 is expected, not '0' (command line)"},
      {{"--scene", "hopper", "--skin", "nan"}, "--skin: a number of 0 or more is expected, not 'nan' (command line)"},
      {{"--scene", "hopper", "stray"}, "stray"},
  };
  for (const Case& c : cases) {
    std::string all;
    for (const char* word : c.words) all += std::string(word) + " ";
    try {
      parse(c.words);
      ADD_FAILURE() << "accepted: " << all;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(c.says), std::string::npos) << all << "-> " << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

TEST(CommandLine, every_option_arrives) {
  const BenchRequest r = parse({"--scene",       "hopper",     "--particles",    "7",
                                "--vertices",    "0",          "--seed",         "18446744073709551615",
                                "--halo",        "published",  "--size-ratio",   "20",
                                "--kernel",      "brute",      "--precheck",     "none",
                                "--grid",        "none",       "--contact-rule", "all-pairs",
                                "--scheme",      "task",       "--runtime",      "tbb",
                                "--threads",     "3",          "--subdivision",  "2",
                                "--end",         "0.25",       "--repeats",      "4",
                                "--warmup",      "5",          "--check-steps",  "6",
                                "--record",      "dir/r.json", "--final-state",  "f.json",
                                "--vtk",         "v",          "--vtk-every",    "0.5",
                                "--start-state", "s.json"});
  EXPECT_EQ(r.scene, "hopper");
  EXPECT_EQ(r.scene_options.particles, 7);
  EXPECT_EQ(r.scene_options.vertices, 0);
  EXPECT_EQ(r.scene_options.seed, 18446744073709551615u);
  EXPECT_EQ(r.scene_options.halo, "published");
  EXPECT_EQ(r.scene_options.size_ratio, 20);
  EXPECT_EQ(r.options.kernel, "brute");
  EXPECT_EQ(r.options.precheck, "none");
  EXPECT_EQ(r.options.grid, "none");
  EXPECT_EQ(r.options.contact_rule, "all-pairs");
  EXPECT_EQ(r.options.scheme, "task");
  EXPECT_EQ(r.options.runtime, "tbb");
  EXPECT_EQ(r.options.threads, 3);
  EXPECT_EQ(r.options.subdivision, 2);
  EXPECT_FALSE(r.steps);
  EXPECT_EQ(r.end, 0.25);
  EXPECT_EQ(r.repeats, 4);
  EXPECT_EQ(r.warmup, 5);
  EXPECT_EQ(r.check_steps, 6);
  EXPECT_EQ(r.record, "dir/r.json");
  EXPECT_EQ(r.point_id, "r") << "the record's name where none is given";
  EXPECT_EQ(r.final_state, "f.json");
  EXPECT_EQ(r.vtk, "v");
  EXPECT_EQ(r.vtk_every, 0.5);
  EXPECT_EQ(r.start_state, "s.json");
}

TEST(CommandLine, extra_params_keep_their_type) {
  const auto params = params_of(
      parse({"--scene", "hopper", "--param", "opening_m=0.05", "--param", "note=a=b", "--param", "cold=true"}));
  EXPECT_EQ(params["opening_m"], 0.05);
  EXPECT_EQ(params["note"], "a=b");
  EXPECT_EQ(params["cold"], true);
}

TEST(CommandLine, extra_params_may_not_contradict_the_options) {
  EXPECT_NO_THROW(params_of(parse({"--scene", "hopper", "--threads", "2", "--param", "threads=2"})));
  EXPECT_THROW(params_of(parse({"--scene", "hopper", "--threads", "2", "--param", "threads=3"})), InputError);
  EXPECT_THROW(params_of(parse({"--scene", "hopper", "--param", "nothing"})), InputError);
  EXPECT_THROW(params_of(parse({"--scene", "hopper", "--param", "=1"})), InputError);
}

TEST(CommandLine, params_hold_the_defaults) {
  const auto params = params_of(parse({"--scene", "hopper"}));
  const Options defaults;
  EXPECT_EQ(params["kernel"], defaults.kernel);
  EXPECT_EQ(params["threads"], defaults.threads);
  EXPECT_EQ(params["particles"], SceneOptions{}.particles);
  EXPECT_TRUE(params["scene_file"].is_null());
}

TEST(CommandLine, a_scene_file_has_no_scene_options) {
  const auto params = params_of(parse({"--scene-file", "s.json"}));
  EXPECT_EQ(params["scene_file"], "s.json");
  EXPECT_TRUE(params["scene"].is_null());
  EXPECT_TRUE(params["particles"].is_null());
}

TEST(CommandLine, list_names_every_choice_of_every_table_once) {
  std::ostringstream out;
  EXPECT_FALSE(parse({"--list"}, out));
  const std::string text = out.str();
  for (const char* title : {"scenes\n", "kernels\n", "prechecks\n", "grids\n", "contact rules\n", "schemes\n",
                            "runtimes\n", "step controls\n"})
    EXPECT_NE(text.find(title), std::string::npos) << title;
  for (const Kernel& kernel : kernels()) {
    const std::string row = "\n  " + std::string(kernel.name) + ": ";
    EXPECT_NE(text.find(row), std::string::npos) << row;
    EXPECT_EQ(text.find(row), text.rfind(row)) << row;
  }
}

TEST(CommandLine, help_names_the_options) {
  std::ostringstream out;
  EXPECT_FALSE(parse({"--help"}, out));
  EXPECT_NE(out.str().find("--check-steps"), std::string::npos);
}

} // namespace
} // namespace trigrain
