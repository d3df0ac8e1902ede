#include "dem/mesh.hpp"
#include "dem/surface.hpp"
#include "dem/vectors.hpp"
#include "kernels/name_table.hpp"
#include <Eigen/Eigenvalues>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace trigrain {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Face = std::array<int, 3>;

constexpr double round_off = 1e-12; ///< what sums over thousands of faces leave where the exact value is 0, relative

struct HashPoint {
  std::size_t operator()(const std::array<double, 3>& p) const {
    std::uint64_t h = 0;
    for (const double c : p) h = (h ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u, h ^= h >> 32;
    return h;
  }
};

void check(const std::string& name, const std::vector<Vector3d>& vertices, const std::vector<Face>& faces) {
  if (faces.empty()) throw InputError("the mesh has no triangles (" + name + "). Give it at least one.");
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (!vertices[i].allFinite())
      throw InputError("vertex " + std::to_string(i) + " is not finite (" + name + "). Give three finite coordinates.");
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (const int v : faces[i])
      if (v < 0 || v >= static_cast<int>(vertices.size()))
        throw InputError("triangle " + std::to_string(i) + " asks for vertex " + std::to_string(v) + " of " +
                         std::to_string(vertices.size()) + " (" + name + "). Use indices from 0 to the last vertex.");
}

/// Gives every point one vertex, however many equal ones came in, in the order in which the faces use them; vertices
/// that no face uses are left out.
void merge_equal_vertices(Mesh& mesh) {
  std::unordered_map<std::array<double, 3>, int, HashPoint> known;
  known.reserve(mesh.vertices.size());
  std::vector<Vector3d> merged;
  for (Face& face : mesh.faces)
    for (int& v : face) {
      const Vector3d p = mesh.vertices[v] + Vector3d::Zero(); // -0 becomes 0
      const auto [at, is_new] = known.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(merged.size()));
      if (is_new) merged.push_back(p);
      v = at->second;
    }
  mesh.vertices = std::move(merged);
}

/// Numbers the pieces of surface that share vertices. Returns how many there are.
int number_parts(Mesh& mesh) {
  std::vector<int> leader(mesh.vertices.size());
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int v) {
    while (leader[v] != v) v = leader[v] = leader[leader[v]];
    return v;
  };
  for (const Face& f : mesh.faces)
    for (const int v : {f[1], f[2]}) leader[find(v)] = find(f[0]);
  std::vector<int> number(mesh.vertices.size(), -1);
  int parts = 0;
  mesh.part.clear();
  for (const Face& f : mesh.faces) {
    int& n = number[find(f[0])];
    if (n < 0) n = parts++;
    mesh.part.push_back(n);
  }
  return parts;
}

/// Per part: is every edge used exactly once in each direction?
std::vector<char> closed_parts(const Mesh& mesh, const std::vector<char>& bounds, int parts) {
  std::vector<char> closed(parts, 0);
  std::vector<int> part_of(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    if (!bounds[i]) continue;
    closed[mesh.part[i]] = 1;
    for (const int v : mesh.faces[i]) part_of[v] = mesh.part[i];
  }
  for (const EdgeUse& use : edge_uses(mesh.faces, bounds))
    if (!use.is_closed()) closed[part_of[use.low]] = 0;
  return closed;
}

/// One connected piece of surface: its faces that bound the solid.
struct Part {
  std::vector<Face> faces;
  std::vector<int> all; ///< numbers of all its faces in the mesh
  Eigen::AlignedBox3d box;
  double volume = 0;
  bool closed = false;
};

std::vector<Part> split(const Mesh& mesh, int parts) {
  const auto bounds = bounding_faces(mesh.faces);
  const auto closed = closed_parts(mesh, bounds, parts);
  std::vector<Part> list(parts);
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    Part& p = list[mesh.part[i]];
    p.all.push_back(static_cast<int>(i));
    if (bounds[i]) p.faces.push_back(mesh.faces[i]);
    for (const int v : mesh.faces[i]) p.box.extend(mesh.vertices[v]);
  }
  for (int n = 0; n < parts; ++n) {
    Part& p = list[n];
    p.closed = closed[n];
    const Vector3d o = p.box.center();
    for (const Face& f : p.faces)
      p.volume += (mesh.vertices[f[0]] - o).dot((mesh.vertices[f[1]] - o).cross(mesh.vertices[f[2]] - o)) / 6;
  }
  return list;
}

/// Is x inside the closed piece? Its winding number by solid angles (van Oosterom and Strackee 1983) is then +-1, not
/// 0.
bool inside(const Mesh& mesh, const Part& part, const Vector3d& x) {
  double solid_angle = 0;
  for (const Face& f : part.faces) {
    const Vector3d a = mesh.vertices[f[0]] - x, b = mesh.vertices[f[1]] - x, c = mesh.vertices[f[2]] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    solid_angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(solid_angle) > 2 * std::numbers::pi;
}

/// Is `inner` a piece of surface inside the solid that `outer` bounds? Looks at some 30 of its vertices: pieces may
/// overlap, but their surfaces are not expected to cross so finely.
bool encloses(const Mesh& mesh, const Part& outer, const Part& inner) {
  if (!outer.box.contains(inner.box)) return false;
  const std::size_t stride = 1 + inner.faces.size() / 30;
  for (std::size_t i = 0; i < inner.faces.size(); i += stride)
    if (!inside(mesh, outer, mesh.vertices[inner.faces[i][0]])) return false;
  return true;
}

/// Turns closed pieces so that their faces look out of the solid: outward, or inward for the wall of a cavity, which is
/// a piece inside an odd number of others.
void orient(Mesh& mesh, std::vector<Part>& parts) {
  std::vector<char> turn(parts.size(), 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].closed) continue;
    bool cavity = false;
    for (std::size_t j = 0; j < parts.size(); ++j)
      if (j != i && parts[j].closed && encloses(mesh, parts[j], parts[i])) cavity = !cavity;
    turn[i] = cavity ? parts[i].volume > 0 : parts[i].volume < 0;
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!turn[i]) continue;
    parts[i].volume *= -1;
    for (Face& f : parts[i].faces) std::swap(f[1], f[2]);
    for (const int f : parts[i].all) std::swap(mesh.faces[f][1], mesh.faces[f][2]);
  }
}

/// Volume, centre and principal moments from the signed tetrahedra between a middle point and each face (Tonon 2004,
/// "Explicit exact formulas for the 3-D tetrahedron inertia tensor"; here as second moments).
void set_mass_properties(Mesh& mesh, const std::vector<Part>& parts) {
  Eigen::AlignedBox3d bounds;
  for (const Vector3d& v : mesh.vertices) bounds.extend(v);
  const Vector3d middle = bounds.center();
  const double extent = bounds.sizes().maxCoeff();
  double volume = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const Part& part : parts) {
    if (!part.closed) return;
    for (const Face& f : part.faces) {
      const Vector3d a = mesh.vertices[f[0]] - middle, b = mesh.vertices[f[1]] - middle,
                     c = mesh.vertices[f[2]] - middle, sum = a + b + c;
      const double v = a.dot(b.cross(c)) / 6;
      volume += v;
      first += v / 4 * sum;
      second += v / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
  }
  if (!(volume > 1e-14 * extent * extent * extent)) return; // flat, or nothing but round-off
  Vector3d centre = first / volume;
  second -= volume * centre * centre.transpose();
  if (centre.norm() <= round_off * extent) centre.setZero();
  const Matrix3d inertia = second.trace() * Matrix3d::Identity() - second;
  const double off_diagonal = std::max({std::abs(inertia(0, 1)), std::abs(inertia(0, 2)), std::abs(inertia(1, 2))});
  mesh.volume = volume;
  mesh.origin = middle + centre;
  mesh.inertia = inertia.diagonal();
  if (off_diagonal <= round_off * inertia.trace()) return; // the shape's own axes already are principal axes
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
  Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) *= -1;
  mesh.inertia = solver.eigenvalues();
  mesh.axes = Eigen::Quaterniond(axes).normalized();
}

void move_to_body_frame(Mesh& mesh) {
  const Matrix3d to_body = mesh.axes.toRotationMatrix().transpose();
  const bool turned = mesh.axes.vec() != Vector3d::Zero();
  for (Vector3d& v : mesh.vertices) {
    v -= mesh.origin;
    if (turned) v = to_body * v;
    mesh.radius = std::max(mesh.radius, v.norm());
  }
  index_triangles(mesh);
}

} // namespace

void index_triangles(Mesh& mesh, Cuts cuts) {
  std::vector<Vec3<double>> vertices;
  for (const Vector3d& v : mesh.vertices) vertices.push_back(vec3(v));
  mesh.triangles.clear();
  for (const Face& f : mesh.faces) mesh.triangles.push_back({vertices[f[0]], vertices[f[1]], vertices[f[2]]});
  mesh.octree = Octree(vertices, mesh.triangles.view(), cuts);
}

Mesh make_mesh(std::string name, std::vector<Vector3d> vertices, std::vector<Face> faces) {
  check(name, vertices, faces);
  Mesh mesh;
  mesh.name = std::move(name);
  mesh.vertices = std::move(vertices);
  mesh.faces = std::move(faces);
  merge_equal_vertices(mesh);
  std::vector<Part> parts = split(mesh, number_parts(mesh));
  orient(mesh, parts);
  set_mass_properties(mesh, parts);
  move_to_body_frame(mesh);
  mesh.features = find_features(mesh.vertices, mesh.faces);
  return mesh;
}

} // namespace trigrain
