#include "dem/scene.hpp"
#include "kernels/name_table.hpp"
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>
#include <unistd.h>

using namespace trigrain;

namespace {

/// A folder of its own for each test, removed afterwards.
class BadInput : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder / name, std::ios::binary) << content;
    return folder / name;
  }
  /// The message with which `load` refuses `name`: one line that ends as a sentence, names the file and what is
  /// `expected`.
  template <class Load>
  void expect_refused(const std::string& name, const std::string& expected, const Load& load) const {
    try {
      load(folder / name);
      ADD_FAILURE() << name << " was accepted; expected " << expected;
    } catch (const InputError& e) {
      const std::string message = e.what();
      EXPECT_NE(message.find(expected), message.npos) << message << "\n  expected: " << expected;
      EXPECT_NE(message.find(name), message.npos) << message << "\n  expected the file's name: " << name;
      EXPECT_EQ(message.find('\n'), message.npos) << message;
      EXPECT_NE(message.find("). "), message.npos) << message << "\n  expected: problem (where). what to do";
      EXPECT_TRUE(message.ends_with('.') || message.ends_with('?')) << message;
    } catch (const std::exception& e) {
      ADD_FAILURE() << name << ": not an InputError: " << e.what();
    }
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("trigrain_bad_input_" + std::to_string(::getpid()));
};

struct Row {
  const char* content;
  const char* expected;
};

/// A scene with one body of that shape and those other keys.
std::string with_body(const std::string& shape, const std::string& more = "") {
  return R"({"bodies": [{"shape": {"sphere_m": 1}}, {"shape": )" + shape + (more.empty() ? "" : ", ") + more + "}]}";
}

std::string with(const std::string& key_and_value) {
  return "{" + key_and_value + R"(, "bodies": [{"shape": {"sphere_m": 1}}]})";
}

std::string binary_stl(std::uint32_t triangles, const std::vector<float>& coordinates) {
  std::string s(80, ' ');
  s.append(reinterpret_cast<const char*>(&triangles), 4);
  for (std::size_t t = 0; t + 9 <= coordinates.size(); t += 9)
    s += std::string(12, '\0') + std::string(reinterpret_cast<const char*>(&coordinates[t]), 36) + std::string(2, '\0');
  return s;
}

const std::string ply_header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                               "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

} // namespace

TEST_F(BadInput, WholeSceneFilesAreRefusedWithTheKey) {
  const Row rows[] = {
      {"", "line 1, column 1"},
      {"[]", "expected an object"},
      {"{}", "the key 'bodies' is missing"},
      {"{\"bodies\": [\n  {\"shape\": {\"sphere_m\": 1},}\n]}", "line 2, column 29"},
      {"{\"bodies\": [\n\n{\"shape\": {\"sphere_m\": NaN}}]}", "line 3, column 24"},
      {"{\"bodies\": [\n{\"shape\": {\"sphere_m\": 1e999}}]}", "line 2, column 24"},
      {"{\"bodies\": [{\"shape\": {\"sphere_m\": 1}}]} tail", "line 1, column 4"},
      {R"({"bodies": []})", "bodies). Give at least one"},
      {R"({"bodies": {}})", "bodies"},
      {R"({"bodies": [7]})", "bodies[0]"},
      {R"({"bodies": [{}]})", "the key 'shape' is missing"},
      {R"({"bodies": [{"shape": {"sphere_m": 1}}], "bodies": []})", "'bodies' appears twice"},
      {R"({"body": [{"shape": {"sphere_m": 1}}]})", "Did you mean 'bodies'"},
      {R"({"bodies": [{"shape": {"sphere_m": 1}}], "a\nb": 1})", "unknown key 'a?b'"},
  };
  for (const Row& row : rows) {
    write("scene.json", row.content);
    expect_refused("scene.json", row.expected, load_scene);
  }
  expect_refused("missing.json", "cannot read", load_scene);
}

TEST_F(BadInput, ValuesOutsideBodiesAreRefusedWithTheirKey) {
  const Row rows[] = {
      {R"("gravity_m_s2": [0, -9.81])", "gravity_m_s2"},
      {R"("gravity_m_s2": [0, "down", 0])", "gravity_m_s2[1]"},
      {R"("gravity": [0, 0, 0])", "Did you mean 'gravity_m_s2'"},
      {R"("domain_m": {"size": 0})", "domain_m.size"},
      {R"("domain_m": {"size": -1})", "domain_m.size"},
      {R"("domain_m": {"min": 0})", "domain_m.min"},
      {R"("contact": {"law": "hertz"})", "Known: spring-dashpot"},
      {R"("contact": {"stiffness_N_m": 0})", "contact.stiffness_N_m"},
      {R"("contact": {"stifness_N_m": 1})", "Did you mean 'stiffness_N_m'"},
      {R"("contact": {"damping_ratio": -0.1})", "contact.damping_ratio"},
      {R"("contact": {"friction": "rough"})", "contact.friction"},
      {R"("contact": {"friction": null})", "contact.friction"},
      {R"("contact": {"tangential_ratio": -1})", "contact.tangential_ratio"},
      {R"("contact": [])", "contact"},
      {R"("time": {"control": "adaptive"})", "Known: fixed"},
      {R"("time": {"step_s": 1e-3, "end_s": 1e-4})", "time"},
      {R"("time": {"step_s": 0})", "time.step_s"},
      {R"("time": {"step_s": true})", "time.step_s"},
      {R"("time": {"end_s": -1})", "time.end_s"},
  };
  for (const Row& row : rows) {
    write("scene.json", with(row.content));
    expect_refused("scene.json", row.expected, load_scene);
  }
}

TEST_F(BadInput, BodiesAreRefusedWithTheirNumberAndKey) {
  const struct {
    const char *shape, *more, *expected;
  } rows[] = {
      {R"({"sphere_m": 1})", R"("density_kg_m3": -1)", "bodies[1].density_kg_m3"},
      {R"({"sphere_m": 1})", R"("density_kg_m3": 0)", "bodies[1].density_kg_m3"},
      {R"({"sphere_m": 1})", R"("desity_kg_m3": 1)", "Did you mean 'density_kg_m3'"},
      {R"({"sphere_m": 1})", R"("color": "red")", "Known: shape, position_m"},
      {R"({"sphere_m": 1})", R"("halo_m": -1e-3)", "bodies[1].halo_m"},
      {R"({"sphere_m": 1})", R"("fixed": 1)", "bodies[1].fixed"},
      {R"({"sphere_m": 1})", R"("fixed": true, "velocity_m_s": [1, 0, 0])", "bodies[1]"},
      {R"({"sphere_m": 1})", R"("position_m": [1, 2, 3, 4])", "bodies[1].position_m"},
      {R"({"sphere_m": 1})", R"("position_m": [1, 2, null])", "bodies[1].position_m[2]"},
      {R"({"sphere_m": 1})", R"("velocity_m_s": "fast")", "bodies[1].velocity_m_s"},
      {R"({"sphere_m": 1})", R"("angular_velocity_rad_s": [])", "bodies[1].angular_velocity_rad_s"},
      {R"({"sphere_m": 1})", R"("orientation_wxyz": [0, 0, 0, 0])", "bodies[1].orientation_wxyz"},
      {R"({"sphere_m": 1})", R"("orientation_wxyz": [1.01, 0, 0, 0])", "bodies[1].orientation_wxyz"},
      {R"({"sphere_m": 1})", R"("orientation_wxyz": [1, 0, 0])", "bodies[1].orientation_wxyz"},
      {R"({"sphere_m": 0})", "", "bodies[1].shape.sphere_m"},
      {R"({"sphere_m": 1, "box_m": [1, 1, 1]})", "", "bodies[1].shape.box_m"},
      {R"({"sphere_m": 1, "subdivide": 2})", "", "bodies[1].shape.subdivide"},
      {R"({})", "", "bodies[1].shape"},
      {R"("sphere")", "", "bodies[1].shape"},
      {R"({"shpere_m": 1})", "", "Did you mean 'sphere_m'"},
      {R"({"box_m": [1, 0, 1]})", "", "bodies[1].shape.box_m[1]"},
      {R"({"box_m": [1, 1]})", "", "bodies[1].shape.box_m"},
      {R"({"box_m": [1, 1, 1], "subdivide": 0})", "", "bodies[1].shape.subdivide"},
      {R"({"box_m": [1, 1, 1], "subdivide": 1.5})", "", "bodies[1].shape.subdivide"},
      {R"({"box_m": [1, 1, 1], "subdivide": 18446744073709551615})", "", "bodies[1].shape.subdivide"},
      {R"({"icosphere": {"radius_m": 1}})", "", "the key 'level' is missing"},
      {R"({"icosphere": {"radius_m": 1, "level": 9}})", "", "bodies[1].shape.icosphere.level"},
      {R"({"granulate": {"diameter_m": 1, "vertices": 3}})", "", "bodies[1].shape.granulate.vertices"},
      {R"({"granulate": {"diameter_m": 1, "seed": -1}})", "", "bodies[1].shape.granulate.seed"},
      {R"({"granulate": {"diameter": 1}})", "", "Did you mean 'diameter_m'"},
      {R"({"hopper": {"width_m": 1, "height_m": 1, "opening_m": 2, "thickness_m": 1}})", "", "bodies[1].shape.hopper"},
      {R"({"hopper": {"width_m": 1, "height_m": 1, "opening_m": 1}})", "", "'thickness_m' is missing"},
      {R"({"plane": {"size_m": 1}})", "", "bodies[1].shape). Close the surface or set"},
      {R"({"mesh": {"file": "nowhere.stl"}})", R"("fixed": true)", "nowhere.stl; "},
      {R"({"mesh": {"file": "part.step"}})", "", "Known: .stl, .obj, .ply, .off"},
      {R"({"mesh": {"file": ""}})", "", "bodies[1].shape.mesh.file"},
      {R"({"mesh": {"file": 3}})", "", "bodies[1].shape.mesh.file"},
      {R"({"mesh": {"file": "a.stl", "scale": 0}})", "", "bodies[1].shape.mesh.scale"},
      {R"({"mesh": {"file": "bad.stl"}})", "", "bad.stl: line 4; "},
      {R"({"mesh": {"file": "bad.stl"}})", "", "bodies[1].shape.mesh.file"},
  };
  write("bad.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 1.0 abc 2.0\n");
  for (const auto& row : rows) {
    write("scene.json", with_body(row.shape, row.more));
    expect_refused("scene.json", row.expected, load_scene);
  }
}

TEST_F(BadInput, MeshFilesAreRefusedWithTheLine) {
  const std::string head = "solid\nfacet normal 0 0 1\nouter loop\n", tail = "endloop\nendfacet\nendsolid\n";
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", points = "0 0 0\n1 0 0\n0 1 0\n";
  const struct {
    const char* name;
    std::string content;
    const char* expected;
  } rows[] = {
      {"word.stl", head + "vertex 0 0 0\nvertex 1.0 abc 2.0\nvertex 0 1 0\n" + tail, "line 5"},
      {"glued.stl", head + "vertex 0 0 0\nvertex 1.0 2.0x 2.0\nvertex 0 1 0\n" + tail, "line 5"},
      {"nan.stl", head + "vertex 0 0 nan\nvertex 1 0 0\nvertex 0 1 0\n" + tail, "line 4"},
      {"inf.stl", head + "vertex 0 0 0\nvertex 1e999 0 0\nvertex 0 1 0\n" + tail, "line 5"},
      {"too_large_for_float.stl", head + "vertex 0 0 0\nvertex 1e99 0 0\nvertex 0 1 0\n" + tail, "not finite"},
      {"two_vertices.stl", head + "vertex 0 0 0\nvertex 1 0 0\n" + tail, "line 6"},
      {"four_numbers.stl", head + "vertex 0 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n" + tail, "line 4"},
      {"cut.stl", head + "vertex 0 0 0\nvertex 1 0 0\n", "found the end of the file"},
      {"prose.stl", "This is not a mesh.\n", "line 1"},
      {"no_triangles.stl", "solid\nendsolid\n", "no_triangles.stl"},
      {"empty.stl", "", "is empty"},
      {"cut_binary.stl", binary_stl(2, std::vector<float>(9, 0)), "needs 184 bytes and this one has 134"},
      {"nan_binary.stl", binary_stl(1, {0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0, 0, 1, 0}),
       "not finite"},
      {"no_triangles_binary.stl", binary_stl(0, {}), "no_triangles_binary.stl"},
      {"word.obj", three + "v 1 x 0\nf 1 2 3\n", "line 4"},
      {"high.obj", three + "f 1 2 3\nf 1 2 9\n", "line 5"},
      {"zero.obj", three + "f 0 1 2\n", "line 4"},
      {"back.obj", three + "f -1 -2 -4\n", "line 4"},
      {"pair.obj", three + "f 1 2\n", "line 4"},
      {"keyword.obj", three + "face 1 2 3\n", "line 4"},
      {"no_faces.obj", three, "no_faces.obj"},
      {"word.off", "OFF\n3 1 3\n0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", "line 4"},
      {"high.off", "OFF\n3 1 3\n" + points + "3 0 1 3\n", "line 6"},
      {"negative.off", "OFF\n3 1 3\n" + points + "3 0 1 -1\n", "line 6"},
      {"cut.off", "OFF\n3 2 3\n" + points + "3 0 1 2\n", "found the end of the file"},
      {"counts.off", "OFF\nmany few\n", "line 2"},
      {"word.ply", ply_header + "0 0 0\n1 - 0\n0 1 0\n3 0 1 2\n", "line 11"},
      {"high.ply", ply_header + points + "3 0 1 3\n", "line 13"},
      {"short_face.ply", ply_header + points + "3 0 1\n", "line 13"},
      {"cut.ply", ply_header + points, "found the end of the file"},
      {"type.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty quad x\n", "line 4"},
      {"no_format.ply", "ply\nelement vertex 3\n", "line 2"},
      {"no_faces.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n", "line 5"},
      {"cut_binary.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
           std::string(30, '\0'),
       "ends before its last face"},
      {"part.step", "ISO-10303-21;", "Known: .stl, .obj, .ply, .off"},
  };
  for (const auto& row : rows) {
    write(row.name, row.content);
    expect_refused(row.name, row.expected, [](const auto& file) { return load_mesh(file); });
  }
  expect_refused("missing.stl", "cannot read", [](const auto& file) { return load_mesh(file); });
  std::filesystem::create_directory(folder / "folder.stl");
  expect_refused("folder.stl", "cannot read", [](const auto& file) { return load_mesh(file); });
  write("fine.off", "OFF\n3 1 3\n" + points + "3 0 1 2\n");
  EXPECT_NO_THROW(load_mesh(folder / "fine.off"));
  for (const double scale : {0., -1., std::numeric_limits<double>::infinity()})
    expect_refused("fine.off", "scale", [scale](const auto& file) { return load_mesh(file, scale); });
}

TEST_F(BadInput, MeshesThatCannotMoveAreRefusedWithThePlace) {
  using Points = std::vector<std::array<double, 3>>;
  using Faces = std::vector<std::array<int, 3>>;
  const auto off = [](const Points& points, const Faces& faces) {
    std::ostringstream s;
    s << "OFF\n" << points.size() << ' ' << faces.size() << " 0\n";
    for (const auto& p : points) s << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    for (const auto& f : faces) s << "3 " << f[0] << ' ' << f[1] << ' ' << f[2] << '\n';
    return s.str();
  };
  // A tetrahedron, and a second one, moved by x.
  const Faces four{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  Faces eight = four;
  for (const auto& f : four) eight.push_back({f[0] + 4, f[1] + 4, f[2] + 4});
  const auto points = [](double size, double x, double y, double z, double size2) {
    Points p{{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    for (int i = 0; i < 4; ++i) p.push_back({x + p[i][0] * size2, y + p[i][1] * size2, z + p[i][2] * size2});
    return p;
  };
  const auto refused = [&](const std::string& mesh, const char* expected) {
    write("part.off", mesh);
    write("scene.json", with_body(R"({"mesh": {"file": "part.off"}})"));
    expect_refused("scene.json", expected, load_scene);
  };
  const auto accepted = [&](const std::string& mesh) {
    write("part.off", mesh);
    write("scene.json", with_body(R"({"mesh": {"file": "part.off"}})"));
    EXPECT_NO_THROW(load_scene(folder / "scene.json"));
  };
  const Points one = points(.5, .8, 0, 0, 1);
  refused(off(one, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}}),
          "(0, 0.5, 0) to (0.5, 0, 0) m has a triangle on one side only, the first of 3 such edges");
  refused(off(one, {{0, 1, 2}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}), "has two triangles that face different ways");
  refused(off(one, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 4}, {1, 0, 4}}), "belongs to 4 triangles");
  refused(off(one, {{0, 1, 2}, {0, 2, 1}}), "encloses no volume");
  refused(off(points(.5, .05, .05, .05, 1), eight), "crosses itself at (0.");
  refused(off(points(500, 1000, 0, 0, 1), eight), "Give a scale (m per unit of the file: 0.001 for mm)");
  accepted(off(one, eight));                                                              // two pieces apart
  accepted(off(points(.5, .05, .05, .05, .5), eight));                                    // one in the other
  accepted(off(points(.5, -.5, 0, 0, 1), eight));                                         // that touch in a corner
  accepted(off(one, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {1, 2, 3}, {0, 0, 1}})); // face twice, without area
}
