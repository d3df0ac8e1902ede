#include "kernels/kernels.hpp"
#include "kernels/brute.hpp"
#include "kernels/hybrid.hpp"
#include "kernels/iterative.hpp"
#include <array>

namespace trigrain {

// Flops: + - * / and square roots of one separated pair whose distance is wanted, counted by running the text with a
// counting number; minima, selects and comparisons are not in it. For brute force the mean over random pairs.
// Bytes: two triangles of nine doubles in, one Hit out.
constexpr double bytes_per_pair = 2 * 9 * sizeof(double) + sizeof(Hit);

constexpr std::array table{
    Kernel{"brute",
           "15 features with branches, crossing decided exactly; Krestenitis (2018), Ericson (2005) 5.1.5, 5.1.9",
           brute, 1400, bytes_per_pair},
    Kernel{"iterative", "four Newton steps of the penalty method; Krestenitis, Weinzierl, Koziara (2017)", iterative,
           730, bytes_per_pair},
    Kernel{"hybrid-pair", "Newton, proven per pair by a separating plane or redone by brute force; Krestenitis (2018)",
           hybrid_pair, 1590, bytes_per_pair},
};

std::span<const Kernel> kernels() { return table; }

} // namespace trigrain
