// The kernels of this project, and the list of all contestants.
#include "experiments/kernel_bench/contestant.hpp"

namespace trigrain {

Placement MeshPair::placement() const {
  const auto row = [&](int k) { return Vec3<double>{rotation(k, 0), rotation(k, 1), rotation(k, 2)}; };
  return {{row(0), row(1), row(2)}, {translation.x(), translation.y(), translation.z()}};
}

std::vector<Contestant> our_kernels() {
  std::vector<Contestant> list;
  for (const Kernel& kernel : kernels()) {
    Contestant c{std::string(kernel.name),
                 std::string(kernel.precision),
                 kernel.lanes,
                 std::string(kernel.about),
                 &kernel,
                 {},
                 {}};
    c.on_triangles = [&kernel](const Problem& problem, const Query& query) {
      return [&kernel, query, list = problem.pair_list()](int first, int count, Hits& hits, KernelCounts& counts) {
        kernel.closest(list.part(first, count), query, hits, counts);
      };
    };
    c.on_meshes = [&kernel](const MeshProblem& problem, const Query& query, const Precheck& precheck) {
      Query within = query;
      within.reach = problem.reach;
      return [&kernel, &problem, &precheck, within, candidates = Candidates()](int k, Hits& hits,
                                                                               KernelCounts& counts) mutable {
        const auto& [a, b, rotation, translation] = problem.pairs[k];
        precheck.pairs({a->triangles.view(), &a->octree}, {b->triangles.view(), &b->octree},
                       problem.pairs[k].placement(), within.reach, candidates);
        kernel.closest({a->triangles.view(), candidates.b.view(), candidates.pairs}, within, hits, counts);
      };
    };
    list.push_back(std::move(c));
  }
  return list;
}

std::vector<Contestant> contestants() {
  std::vector<Contestant> list = our_kernels();
#ifdef TRIGRAIN_FCL
  list.push_back(fcl_contestant());
#endif
#ifdef TRIGRAIN_CGAL
  list.push_back(cgal_contestant());
#endif
#ifdef TRIGRAIN_BULLET
  list.push_back(bullet_contestant());
#endif
#ifdef TRIGRAIN_ODE
  list.push_back(ode_contestant());
#endif
  return list;
}

} // namespace trigrain
