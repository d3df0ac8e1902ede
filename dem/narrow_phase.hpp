#pragma once
#include "dem/contact_rule.hpp"
#include "dem/grid.hpp"
#include "kernels/kernels.hpp"
#include <span>
#include <string_view>
#include <vector>

namespace trigrain {

/// Cheap tests before the kernel. Conservative: the contacts are the same set as without them.
struct Precheck {
  std::string_view name;
  std::string_view about;
  /// May the two bodies touch?
  bool (*bodies)(const Particles& particles, BodyPair pair);
  /// Ascending indices of the triangles that may come closer than `reach` to the point (m, their frame).
  void (*triangles)(TrianglesView triangles, const Vec3<double>& point, double reach, std::vector<int>& indices);
};

std::span<const Precheck> prechecks();

/// How body pairs are turned into contacts.
struct NarrowPhase {
  const Kernel* kernel;
  const Precheck* precheck;
  const ContactRule* rule;
};

/// What one worker finds during a step, and its scratch memory. Written by that worker only.
struct WorkerBuffer {
  std::vector<Contact> contacts; ///< contacts of one body pair stand together, in the order of their features
  std::int64_t candidate_pairs = 0, body_pairs = 0;
  std::int64_t crossings = 0; ///< triangle or sphere pairs found at distance 0
  KernelCounts kernel;

  double reach = 0; ///< of the pair at hand: sum of its halos (m)
  std::vector<BodyPair> pairs;
  Triangles near_a, near_b;
  std::vector<int> index_a, index_b;
  std::vector<Vec3<double>> vertices;
  Hits hits;

  void clear();
};

/// Finds the contacts of one body pair and appends them to the buffer. Crossing surfaces have no normal: they are
/// counted and give no contact.
void collide(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer);

} // namespace trigrain
