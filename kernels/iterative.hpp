#pragma once
#include "kernels/kernels.hpp"

namespace trigrain {

/// Four Newton steps of the penalty method for every pair, over lanes: the published baseline. Not exact, but honest:
/// p and q lie in their triangles, `upper` is their distance and `lower` the certificate of it.
template <class T> void iterative(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts);

} // namespace trigrain
