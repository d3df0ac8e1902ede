#include "dem/grid_kind.hpp"

namespace trigrain {
namespace {

bool never(const CellQuestion&) { return false; }
bool fits(const CellQuestion& q) { return q.child_size >= q.diameter; }

/// From so many comparisons of one body on, splitting is cheaper than comparing: some ten vectors of distances.
constexpr int crowd = 64;

constexpr GridKind table[] = {
    {"none", "one cell: every body meets every other", never, never},
    {"regular", "cells everywhere as fine as the smallest body allows (Krestenitis 2018)", fits, never},
    {"linked-cells", "one level of cells as wide as the widest body that moves (Allen & Tildesley 1987)", fits, never,
     true},
    {"regular-dense", "regular, all of its vertices stored and visited in every step, as published", fits, never, false,
     true},
    {"adaptive", "cells as fine as the bodies near them allow, and gone with them (Krestenitis 2018)",
     [](const CellQuestion& q) { return fits(q) && q.bodies > 0; },
     [](const CellQuestion& q) { return q.bodies == 0; }},
    {"reluctant", "cells split only where bodies approach and overlap, or crowd; they outlast them (Krestenitis 2018)",
     [](const CellQuestion& q) { return fits(q) && ((q.bodies >= 2 && q.approaching) || q.bodies > crowd); },
     [](const CellQuestion& q) { return q.bodies == 0 && q.mass < 2; }},
};

} // namespace

std::span<const GridKind> grid_kinds() { return table; }

} // namespace trigrain
