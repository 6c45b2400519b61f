// The number formats of the kernels' arithmetic (kernels/number/README.md), on the host.
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

/// Parses "fp32", "spa22" (e6m15), "eXmY" or "eXmYt". UserError with the legal values.
NumberFormat parse_format(const std::string& text);

/// "fp32", "e6m15", "e6m15t".
std::string format_name(const NumberFormat& format);

/// The smallest positive normal number. Smaller results may be flushed to zero.
double smallest_number(const NumberFormat& format);

/// The maximum distance of a hit (RAYA_FAR of kernels/number/): its square does not overflow.
double farthest_hit(const NumberFormat& format);

/// Converts `value` to the format: rounds once, saturates at the largest number, flushes to zero below the smallest.
/// std::invalid_argument for NaN.
float round_to_format(double value, const NumberFormat& format);

}  // namespace raya
