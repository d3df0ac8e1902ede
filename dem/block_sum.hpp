#pragma once
#include "dem/runtime.hpp"
#include <algorithm>
#include <vector>

namespace trigrain {

/// Sum over [0, count), to which add(begin, end, sum) adds a part: in blocks of fixed size that are added up in order,
/// so that it has the same bits for every team. `blocks` is scratch memory.
template <class Sum, class Add> Sum block_sum(Team& team, int count, std::vector<Sum>& blocks, const Add& add) {
  constexpr int block = 64, blocks_at_once = 4;
  blocks.assign((count + block - 1) / block, Sum{});
  team.parallel_for(static_cast<int>(blocks.size()), blocks_at_once, [&](int begin, int end, int) {
    for (int b = begin; b < end; ++b) {
      Sum sum{}; // not in `blocks`: neighbours there share cache lines
      add(b * block, std::min(count, (b + 1) * block), sum);
      blocks[b] = sum;
    }
  });
  Sum sum{};
  for (const Sum& each : blocks) sum += each;
  return sum;
}

} // namespace trigrain
