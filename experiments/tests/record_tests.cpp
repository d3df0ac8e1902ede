#include "experiments/build_info.hpp"
#include "experiments/record.hpp"
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace trigrain {
namespace {

BenchRequest tiny() {
  BenchRequest request;
  request.scene = "two-particles";
  request.steps = 5;
  request.repeats = 3;
  request.warmup = 2;
  return request;
}

TEST(Record, samples_time_the_same_work) {
  const PointResult point = run_point(tiny(), {});
  ASSERT_EQ(point.samples.size(), 3u);
  for (const Sample& sample : point.samples) {
    EXPECT_EQ(sample.stats.steps, 5);
    EXPECT_EQ(sample.state_hash, point.samples[0].state_hash);
    EXPECT_EQ(sample.stats.candidate_pairs, point.samples[0].stats.candidate_pairs);
    EXPECT_GT(sample.used.wall, 0);
    double phases = 0;
    for (const double seconds : sample.stats.seconds) phases += seconds;
    EXPECT_GT(phases, 0);
    EXPECT_LE(phases, sample.used.wall);
  }
}

TEST(Record, a_sample_of_simulated_time_has_that_many_steps) {
  BenchRequest request = tiny();
  request.steps.reset();
  const double step = starting_point(request).scene.time.step;
  request.end = 7 * step;
  request.repeats = 1;
  EXPECT_EQ(run_point(request, {}).samples[0].stats.steps, 7);
}

TEST(Record, watching_changes_nothing) {
  BenchRequest request = tiny();
  double share = 0;
  const PointResult watched = run_point(request, [&](const Progress& progress) { share = progress.share; });
  EXPECT_EQ(share, 1);
  EXPECT_EQ(watched.samples[0].state_hash, run_point(request, {}).samples[0].state_hash);
}

TEST(Record, frames_come_at_the_simulated_times_asked_for) {
  BenchRequest request = tiny();
  const double step = starting_point(request).scene.time.step;
  request.steps = 10;
  request.warmup = 0;
  request.vtk = std::filesystem::path(testing::TempDir()) / ("trigrain_frames_" + std::to_string(::getpid()));
  request.vtk_every = 2.5 * step;
  run_point(request, {});
  std::ifstream list(request.vtk / "frames.pvd");
  const std::string text(std::istreambuf_iterator<char>(list), {});
  std::vector<double> steps; // the first step at or after each multiple of vtk_every, and the last
  for (auto at = text.find("timestep=\""); at != std::string::npos; at = text.find("timestep=\"", at + 1))
    steps.push_back(std::round(std::stod(text.substr(at + 10)) / step * 1e6) / 1e6);
  EXPECT_EQ(steps, (std::vector<double>{0, 3, 5, 8, 10}));
  std::filesystem::remove_all(request.vtk);
}

TEST(Record, numbers_come_back_bit_by_bit) {
  const PointResult point = run_point(tiny(), {});
  const auto record = nlohmann::json::parse(make_record(point, "id").dump(1));
  ASSERT_EQ(record["samples"].size(), 3u);
  EXPECT_EQ(record["samples"][1]["wall_s"].get<double>(), point.samples[1].used.wall);
  EXPECT_EQ(record["samples"][2]["phases_s"]["detect"].get<double>(), point.samples[2].stats.seconds[1]);
  EXPECT_EQ(record["samples"][2]["search_s"].get<double>(), point.samples[2].search);
  EXPECT_GT(point.samples[2].search, 0);
  EXPECT_EQ(record["energy_J"]["final"]["kinetic"].get<double>(), point.samples[2].final.kinetic);
  EXPECT_EQ(record["counts"]["candidate_pairs"], point.samples[0].stats.candidate_pairs);
  EXPECT_EQ(std::stoull(record["state_hash"].get<std::string>(), nullptr, 16), point.samples[0].state_hash);
  EXPECT_EQ(record["point_id"], "id");
  EXPECT_EQ(record["scene"]["moving_bodies"], 2);
}

TEST(Record, flags_are_those_that_the_compiler_was_given) {
  EXPECT_NE(build_info.flags.find("-std=c++20"), std::string_view::npos);
  EXPECT_EQ(build_info.flags.find('$'), std::string_view::npos) << build_info.flags;
}

TEST(Record, a_failed_check_leaves_no_times) {
  PointResult point = run_point(tiny(), {});
  point.samples.clear();
  point.check.how.push_back({"kernel", false, "made up"});
  const auto record = make_record(point, "id");
  EXPECT_EQ(record["check"]["passed"], false);
  EXPECT_TRUE(record["samples"].empty());
  EXPECT_TRUE(record["counts"].is_null());
  EXPECT_TRUE(record["state_hash"].is_null());
}

TEST(Record, more_threads_than_cores_is_said) {
  BenchRequest request = tiny();
  request.options.scheme = "plain";
  request.options.threads = usable_cores() + 1;
  const auto record = make_record(run_point(request, {}), "id");
  EXPECT_EQ(record["placement"]["oversubscribed"], true);
  EXPECT_NE(record["warnings"].dump().find("not a measurement"), std::string::npos);
}

} // namespace
} // namespace trigrain
