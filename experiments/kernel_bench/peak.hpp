#pragma once
#include <string_view>

namespace trigrain {

/// Measured limits of one core: fused multiply-adds in full registers (flop/s), and bytes/s read from an array of
/// `bytes`. About a tenth of a second each.
double measured_peak_flops(std::string_view precision);
double measured_bandwidth(double bytes);

} // namespace trigrain
