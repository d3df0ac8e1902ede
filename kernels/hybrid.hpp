#pragma once
#include "kernels/kernels.hpp"

namespace trigrain {

/// Newton over lanes, its features solved exactly, and a proof per pair: no contact where a separating plane shows a
/// gap beyond `reach`; the answer where its bounds agree; brute force otherwise (fell_back). As exact as brute force,
/// and the same contacts for every reach. Krestenitis (2018), hybrid with one triangle pair as the unit of falling
/// back.
template <class T> void hybrid_pair(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts);

} // namespace trigrain
