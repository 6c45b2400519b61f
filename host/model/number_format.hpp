// The number formats of the kernels' arithmetic (kernels/number/README.md), on the host.
#pragma once
#include <cstdint>
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

// Texts of counts, sizes, times and rates, for messages and reports. 1 KB = 1024 bytes, 1 MB = 1024 KB.

/// Returns a count with its noun: "1 frame", "2 frames". The default plural is `singular` with an s.
std::string counted(std::uint64_t count, const std::string& singular, const std::string& plural = "");

/// Return a size. A size below 1 KB is in bytes: "12 bytes". Any other size is in KB with one decimal: "12.3 KB". An
/// available size of whole KB has no decimal: "12 KB". A required size is rounded up and an available size is rounded
/// down, so that the texts never suggest that data fits if it does not.
std::string required_size_text(std::uint64_t bytes);
std::string available_size_text(std::uint64_t bytes);

/// Returns an amount of data that is not compared with a limit. Below 10,000 bytes: "12 bytes". Below a million bytes:
/// "12.3 KB". From a million bytes on: "12.3 MB".
std::string data_text(double bytes);

/// Returns a time. Below ten seconds: "12.3 ms". Below ten minutes: "12.3 s". Below ten hours: "12.3 min". From ten
/// hours on: "12.3 h".
std::string time_text(double ms);

/// Returns a rate. Below 1000 rays per second: "12.3 rays/s". Below a million: "12.3 krays/s". From a million on:
/// "12.3 Mrays/s".
std::string rate_text(double rays_per_s);

}  // namespace raya
