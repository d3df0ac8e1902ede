#pragma once
#include "kernels/kernels.hpp"

namespace trigrain {

/// Four Newton steps of the penalty method for every pair, over lanes: the published baseline. Not exact, but honest:
/// p and q lie in their triangles, `upper` is their distance and `lower` the certificate of it.
void iterative(TrianglesView a, TrianglesView b, double reach, std::vector<Hit>& hits, KernelCounts& counts);

} // namespace trigrain
