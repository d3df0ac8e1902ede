#pragma once
#include "dem/contact_rule.hpp"
#include "dem/grid.hpp"
#include "kernels/precheck.hpp"
#include <span>
#include <string_view>
#include <vector>

namespace trigrain {

/// May two bodies touch, as far as the pre-check can tell from their bounding spheres?
bool may_touch(const Particles& particles, BodyPair pair, const Precheck& precheck);

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
  Candidates candidates;
  std::vector<int> near; ///< triangles near a sphere
  Hits hits;

  void clear();
};

/// Finds the contacts of one body pair and appends them to the buffer. Crossing surfaces have no normal: they are
/// counted and give no contact.
void collide(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer);

} // namespace trigrain
