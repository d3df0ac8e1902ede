#pragma once
#include "kernels/kernels.hpp"

namespace trigrain {

// The hybrids of Krestenitis (2018): Newton over lanes, its features solved exactly, and a proof per pair: no contact
// where a separating plane shows a gap beyond `reach`, the answer where its bounds agree. What is not proven is redone
// by brute force (fell_back), so that they are as exact and find the same contacts for every reach.

/// Pairs are redone one by one.
template <class T> void hybrid_pair(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts);

/// One pair without proof, and all of its batch of query.batch pairs are redone together.
template <class T> void hybrid_batch(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts);

} // namespace trigrain
