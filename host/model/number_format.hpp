// The number formats of the kernels' arithmetic (kernels/number/README.md), on the host.
#pragma once
#include <string>

namespace raya {

/// A floating-point format eXmY: 1 sign bit, X exponent bits, Y fraction bits; results are rounded to nearest (ties to
/// even) or toward zero. The default is fp32.
struct NumberFormat {
    int exponent_bits = 8;   // X: 5..8
    int fraction_bits = 23;  // Y: 4..21, or 23 for fp32
    bool truncates = false;  // true: rounds toward zero

    bool is_fp32() const { return fraction_bits == 23; }
    bool operator==(const NumberFormat&) const = default;
};

/// Parses "fp32", "spa22" (e6m15), "eXmY" or "eXmYt" (t: rounds toward zero). Throws UserError, with the valid values,
/// for any other text.
NumberFormat parse_format(const std::string& text);

/// Returns the name of a format, which parse_format() accepts: "fp32", "e6m15", "e6m15t".
std::string format_name(const NumberFormat& format);

/// Returns the smallest positive normal number. Results with a smaller magnitude may be flushed to zero.
double smallest_number(const NumberFormat& format);

/// Returns the maximum distance of a hit (RAYA_FAR in kernels/number/). The square of this distance does not overflow.
double farthest_hit(const NumberFormat& format);

/// Converts `value` to the format: rounds once, saturates at the largest number, and flushes magnitudes below
/// smallest_number() to zero. Throws std::invalid_argument for NaN.
float round_to_format(double value, const NumberFormat& format);

}  // namespace raya
