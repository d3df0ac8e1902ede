// ODE (BSD-3): collision of two triangle meshes. It reports where surfaces cross, so a gap is no contact to it.
#include "experiments/kernel_bench/contestant.hpp"
#include "experiments/kernel_bench/peer.hpp"
#include <map>
#include <memory>
#include <ode/ode.h>

namespace trigrain {
namespace {

/// A mesh in ODE's types, which keep pointers to the numbers.
struct OdeMesh {
  std::vector<double> vertices;
  std::vector<dTriIndex> indices;
  dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomID geom;

  explicit OdeMesh(const Mesh& mesh) {
    for (const Eigen::Vector3d& v : mesh.vertices) vertices.insert(vertices.end(), {v.x(), v.y(), v.z()});
    for (const auto& face : mesh.faces)
      for (const int k : face) indices.push_back(static_cast<dTriIndex>(k));
    dGeomTriMeshDataBuildDouble(data, vertices.data(), 3 * sizeof(double), static_cast<int>(mesh.vertices.size()),
                                indices.data(), static_cast<int>(indices.size()), 3 * sizeof(dTriIndex));
    geom = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  }
  OdeMesh(const OdeMesh&) = delete;
  OdeMesh& operator=(const OdeMesh&) = delete;
  ~OdeMesh() {
    dGeomDestroy(geom);
    dGeomTriMeshDataDestroy(data);
  }
};

struct Library {
  Library() { dInitODE2(0); }
  ~Library() { dCloseODE(); }
};

MeshPass on_meshes(const MeshProblem& problem, const Query&, const Precheck&) {
  static const Library library;
  // B is moved, so it must not be the same geometry as A.
  auto a = std::make_shared<std::map<const Mesh*, OdeMesh>>(), b = std::make_shared<std::map<const Mesh*, OdeMesh>>();
  for (const MeshPair& pair : problem.pairs) {
    a->try_emplace(pair.a, *pair.a);
    b->try_emplace(pair.b, *pair.b);
  }
  return [a, b, &problem](int k, Hits& hits, KernelCounts&) {
    const MeshPair& pair = problem.pairs[k];
    const dGeomID ga = a->at(pair.a).geom, gb = b->at(pair.b).geom;
    const Eigen::Matrix3d& r = pair.rotation;
    const dMatrix3 rotation{r(0, 0), r(0, 1), r(0, 2), 0, r(1, 0), r(1, 1), r(1, 2), 0, r(2, 0), r(2, 1), r(2, 2), 0};
    dGeomSetPosition(gb, pair.translation.x(), pair.translation.y(), pair.translation.z());
    dGeomSetRotation(gb, rotation);
    std::array<dContactGeom, 64> found;
    const int n = dCollide(ga, gb, static_cast<int>(found.size()), found.data(), sizeof(dContactGeom));
    for (int c = 0; c < n; ++c) {
      const Vec3<double> x{found[c].pos[0], found[c].pos[1], found[c].pos[2]};
      hits.push_back({found[c].side1, found[c].side2, unbounded(x, x, 0)});
    }
  };
}

} // namespace

Contestant ode_contestant() {
  return {"ode",    sizeof(dReal) == 4 ? "float" : "double",
          1,        "ODE: collision of two triangle meshes, crossings only",
          nullptr,  {},
          on_meshes};
}

} // namespace trigrain
