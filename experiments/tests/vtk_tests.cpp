#include "dem/pair_source.hpp"
#include "experiments/vtk.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <regex>
#include <unistd.h>

namespace trigrain {
namespace {

namespace fs = std::filesystem;

/// Bytes of a base64 text, up to its padding.
std::string decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned group = 0, bits = 0;
  for (const char c : text) {
    const auto digit = digits.find(c);
    if (digit == std::string::npos) break;
    group = group << 6 | static_cast<unsigned>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(group >> bits & 0xff);
  }
  return bytes;
}

/// The array `name` of a .vtp: offset from its tag, length from its header.
template <class T> std::vector<T> array_of(const std::string& vtp, const std::string& name) {
  std::smatch match;
  EXPECT_TRUE(std::regex_search(vtp, match, std::regex("Name=\"" + name + "\"[^>]*offset=\"(\\d+)\""))) << name;
  const std::string bytes = decoded(vtp.substr(vtp.find("\n_") + 2 + std::stoul(match[1])));
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  EXPECT_GE(bytes.size(), length + sizeof length) << name;
  std::vector<T> values(length / sizeof(T));
  std::memcpy(values.data(), bytes.data() + sizeof length, length);
  return values;
}

Particles cube_and_sphere() {
  Particles particles;
  particles.add({.mesh = std::make_shared<const Mesh>(box({1, 1, 1})),
                 .position = {10, 0, 0},
                 .orientation = Eigen::Quaterniond(Eigen::AngleAxisd(.3, Eigen::Vector3d::UnitZ())),
                 .velocity = {3, 4, 0}});
  particles.add({.mesh = nullptr, .sphere_radius = .5, .position = {0, 2, 0}});
  return particles;
}

TEST(Vtk, a_frame_holds_every_triangle_where_it_is) {
  const Particles particles = cube_and_sphere();
  const std::string vtp = vtp_text(particles);
  const auto points = array_of<double>(vtp, "position_m");
  const auto corners = array_of<std::int64_t>(vtp, "connectivity"), ends = array_of<std::int64_t>(vtp, "offsets");
  const auto body = array_of<std::int32_t>(vtp, "body");
  const auto speed = array_of<double>(vtp, "speed_m_s");
  const std::size_t triangles = 12 + 320; // a cube, and an icosahedron cut in four twice
  ASSERT_EQ(ends.size(), triangles);
  ASSERT_EQ(corners.size(), 3 * triangles);
  ASSERT_EQ(body.size(), triangles);
  EXPECT_EQ(std::count(body.begin(), body.end(), 1), 320);
  for (std::size_t t = 0; t < triangles; ++t) {
    EXPECT_EQ(ends[t], static_cast<std::int64_t>(3 * t + 3));
    EXPECT_DOUBLE_EQ(speed[t], body[t] == 0 ? 5 : 0);
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(corners[3 * t + k]);
      ASSERT_LT(3 * corner + 2, points.size());
      const Eigen::Vector3d x(points[3 * corner], points[3 * corner + 1], points[3 * corner + 2]);
      const Eigen::Vector3d local = particles.to_body(body[t], x);
      if (body[t] == 0)
        EXPECT_NEAR(local.cwiseAbs().maxCoeff(), .5, 1e-14) << "a corner of the cube";
      else
        EXPECT_NEAR(local.norm(), .5, 1e-14) << "on the sphere";
    }
  }
}

TEST(Vtk, arrays_of_any_length_come_back) {
  for (int bodies = 1; bodies <= 3; ++bodies) { // 16, 24, 32 bytes: every length of the last group of three
    Particles particles;
    for (int i = 0; i < bodies; ++i)
      particles.add({.mesh = std::make_shared<const Mesh>(plane(1)), .position = {0, 1. * i, 0}, .fixed = true});
    const auto body = array_of<std::int32_t>(vtp_text(particles), "body");
    ASSERT_EQ(static_cast<int>(body.size()), 2 * bodies);
    EXPECT_EQ(body.back(), bodies - 1);
  }
}

TEST(Vtk, the_list_of_frames_has_times_and_files) {
  const std::string pvd = pvd_text({{0, "frame_00000.vtp"}, {.1, "frame_00001.vtp"}});
  EXPECT_NE(pvd.find("timestep=\"0.0\" file=\"frame_00000.vtp\""), std::string::npos) << pvd;
  EXPECT_NE(pvd.find("timestep=\"0.1\" file=\"frame_00001.vtp\""), std::string::npos) << pvd;
}

TEST(Vtk, frames_and_their_list_are_in_the_folder) {
  const fs::path folder = fs::path(testing::TempDir()) / ("trigrain_vtk_" + std::to_string(::getpid()));
  FrameWriter frames(folder);
  frames.write(cube_and_sphere(), nullptr, 0);
  frames.write(cube_and_sphere(), nullptr, .5);
  EXPECT_TRUE(fs::exists(folder / "frame_00000.vtp"));
  EXPECT_TRUE(fs::exists(folder / "frame_00001.vtp"));
  EXPECT_TRUE(fs::exists(folder / "frames.pvd"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 3);
  fs::remove_all(folder);
}

TEST(Vtk, cells_of_a_grid_fill_the_domain_without_overlap) {
  Particles balls;
  for (const double x : {.1, .13, .8}) balls.add({.mesh = nullptr, .sphere_radius = .01, .position = {x, .2, .3}});
  const Domain domain{.min = {-1, 0, 0}, .size = 2};
  for (const char* grid : {"none", "regular", "regular-dense", "adaptive"}) {
    const auto source = make_pair_source({.grid = grid}, domain, balls);
    Team team(row_named(runtimes(), "runtime", "serial"), 1);
    source->update(balls, team);
    const std::string vtu = vtu_text(*source->tree());
    const auto points = array_of<double>(vtu, "position_m");
    const auto corners = array_of<std::int64_t>(vtu, "connectivity");
    const auto level = array_of<std::int32_t>(vtu, "level");
    const auto types = array_of<std::uint8_t>(vtu, "types");
    ASSERT_EQ(types.size(), level.size());
    ASSERT_EQ(corners.size(), 8 * level.size());
    double volume = 0;
    for (std::size_t c = 0; c < level.size(); ++c) {
      EXPECT_EQ(types[c], 11);
      const double *low = &points[3 * corners[8 * c]], *high = &points[3 * corners[8 * c + 7]];
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(high[axis] - low[axis], 2 / std::pow(3, level[c]), 1e-12);
        EXPECT_GE(low[axis], domain.min[axis] - 1e-12);
        EXPECT_LE(high[axis], domain.min[axis] + 2 + 1e-12);
      }
      volume += std::pow(2 / std::pow(3, level[c]), 3);
    }
    EXPECT_NEAR(volume, 8, 1e-9) << grid;
    EXPECT_EQ(*std::max_element(level.begin(), level.end()), std::string_view(grid) == "none" ? 0 : 4);
  }
}

TEST(Vtk, a_folder_that_cannot_be_made_is_an_input_error) {
  EXPECT_THROW(FrameWriter("/missing/folder/frames"), InputError);
}

} // namespace
} // namespace trigrain
