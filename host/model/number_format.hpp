// The number formats that kernels compute in (kernels/number/README.md), as the host knows them.
#pragma once
#include <string>

namespace raya {

/// eXmY: 1 sign bit, X exponent bits, Y fraction bits, rounded to nearest (ties to even) or toward zero. fp32 is the
/// default.
struct NumberFormat {
    int exponent_bits = 8;   // X: 5..8
    int fraction_bits = 23;  // Y: 4..21, or 23 for fp32
    bool truncates = false;

    bool is_fp32() const { return fraction_bits == 23; }
    bool operator==(const NumberFormat&) const = default;
};

/// "fp32", "spa22" (e6m15), "eXmY" or "eXmYt". UserError names the legal values.
NumberFormat parse_format(const std::string& text);

/// "fp32", "e6m15", "e6m15t".
std::string format_name(const NumberFormat& format);

/// The smallest number above zero that every operation keeps; fp32's denormals are not counted.
double smallest_number(const NumberFormat& format);

/// Farthest distance at which a hit counts (RAYA_FAR of kernels/number/): its square is still in the format.
double farthest_hit(const NumberFormat& format);

/// The number of the format for `value`: rounded once, saturated at the largest number, flushed to zero below the
/// smallest. Throws std::invalid_argument for NaN.
float round_to_format(double value, const NumberFormat& format);

}  // namespace raya
