// Bullet (zlib): GJK on two triangle shapes without margin, in its own precision.
#include "experiments/kernel_bench/contestant.hpp"
#include "experiments/kernel_bench/peer.hpp"
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <algorithm>
#include <btBulletCollisionCommon.h>
#include <memory>

namespace trigrain {
namespace {

using Shapes = std::vector<std::pair<std::unique_ptr<btTriangleShape>, std::unique_ptr<btTriangleShape>>>;

std::unique_ptr<btTriangleShape> shape(const Triangle& t) {
  const auto v = [&](int k) {
    const Vec3<double>& c = corner(t, k);
    return btVector3(static_cast<btScalar>(c.x), static_cast<btScalar>(c.y), static_cast<btScalar>(c.z));
  };
  auto s = std::make_unique<btTriangleShape>(v(0), v(1), v(2));
  s->setMargin(0);
  return s;
}

TrianglePass on_triangles(const Problem& problem, const Query&) {
  auto shapes = std::make_shared<Shapes>();
  for (const Pair& pair : problem.pairs) shapes->emplace_back(shape(pair.a), shape(pair.b));
  return [shapes](int first, int count, Hits& hits, KernelCounts& counts) {
    btVoronoiSimplexSolver simplex;
    btGjkEpaPenetrationDepthSolver depth;
    const auto ours = [](const btVector3& v) { return Vec3<double>{v.x(), v.y(), v.z()}; };
    for (int k = first; k < first + count; ++k) {
      btGjkPairDetector detector((*shapes)[k].first.get(), (*shapes)[k].second.get(), &simplex, &depth);
      btGjkPairDetector::ClosestPointInput input;
      input.m_transformA.setIdentity();
      input.m_transformB.setIdentity();
      btPointCollector found;
      detector.getClosestPoints(input, found, nullptr);
      const btVector3 q = found.m_pointInWorld, p = q + found.m_normalOnBInWorld * found.m_distance;
      const double d = found.m_hasResult ? std::max(static_cast<double>(found.m_distance), 0.) : 0.;
      hits.push_back({k, k, unbounded(ours(p), ours(q), d)});
    }
    counts.triangle_pairs += count;
  };
}

} // namespace

Contestant bullet_contestant() {
  return {"bullet", sizeof(btScalar) == 4 ? "float" : "double",
          1,        "Bullet: GJK on two triangles, no margin",
          nullptr,  on_triangles,
          {}};
}

} // namespace trigrain
