#include "host/model/number_format.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "host/error.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kKb = 1024;

// Rounds to `bits` fraction bits, ties to even; truncates if `truncates`. A carry out of the fraction gives the next
// power of two, or infinity. The result for denormal doubles does not matter: they are below the range of every format.
double with_fraction_bits(double value, int bits, bool truncates) {
    constexpr int kDoubleFractionBits = 52;
    const int dropped = kDoubleFractionBits - bits;
    auto pattern = std::bit_cast<std::uint64_t>(value);
    const std::uint64_t unit = std::uint64_t{1} << dropped;
    if (!truncates) pattern += unit / 2 - 1 + (pattern >> dropped & 1);
    return std::bit_cast<double>(pattern & ~(unit - 1));
}

}  // namespace

NumberFormat parse_format(const std::string& text) {
    if (text == "fp32") return {};
    if (text == "spa22") return {6, 15, false};
    for (int exponent_bits = 5; exponent_bits <= 8; ++exponent_bits)
        for (int fraction_bits = 4; fraction_bits <= 21; ++fraction_bits)
            for (const bool truncates : {false, true})
                if (const NumberFormat format{exponent_bits, fraction_bits, truncates}; format_name(format) == text)
                    return format;
    throw UserError(
        fmt::format("--format {}: must be fp32, spa22 (e6m15), or eXmY with X = 5..8 exponent and Y = 4..21 fraction "
                    "bits; append t to truncate",
                    text));
}

std::string format_name(const NumberFormat& format) {
    if (format.is_fp32()) return "fp32";
    return fmt::format("e{}m{}{}", format.exponent_bits, format.fraction_bits, format.truncates ? "t" : "");
}

double smallest_number(const NumberFormat& format) { return std::ldexp(1.0, 2 - (1 << (format.exponent_bits - 1))); }

double farthest_hit(const NumberFormat& format) {
    constexpr int kFp32Exponent = 60;  // RAYA_FAR of fp32 is 2^60
    return std::ldexp(1.0, std::min((1 << (format.exponent_bits - 2)) - 1, kFp32Exponent));
}

float round_to_format(double value, const NumberFormat& format) {
    if (std::isnan(value)) throw std::invalid_argument("no format represents NaN");
    // Large scenes have hundreds of millions of numbers, nearly all of them normal ones in fp32.
    if (const float x = static_cast<float>(value); format.is_fp32() && std::abs(x) > 0x1p-126F && std::isfinite(x))
        return x;
    const int highest = (1 << (format.exponent_bits - 1)) - 1;
    const double rounded = with_fraction_bits(value, format.fraction_bits, format.truncates);
    const double largest = std::ldexp(2 - std::ldexp(1.0, -format.fraction_bits), highest);
    if (std::abs(rounded) > largest) return static_cast<float>(std::copysign(largest, value));
    if (std::abs(rounded) < smallest_number(format)) return static_cast<float>(std::copysign(0.0, value));
    return static_cast<float>(rounded);
}

std::string counted(std::uint64_t count, const std::string& singular, const std::string& plural) {
    return fmt::format("{} {}", count, count == 1 ? singular : plural.empty() ? singular + 's' : plural);
}

std::string required_size_text(std::uint64_t bytes) {
    if (bytes < kKb) return fmt::format("{} bytes", bytes);
    return fmt::format("{:.1f} KB", std::ceil(10. * static_cast<double>(bytes) / kKb) / 10);
}

std::string available_size_text(std::uint64_t bytes) {
    if (bytes < kKb) return fmt::format("{} bytes", bytes);
    if (bytes % kKb == 0) return fmt::format("{} KB", bytes / kKb);
    return fmt::format("{:.1f} KB", std::floor(10. * static_cast<double>(bytes) / kKb) / 10);
}

std::string data_text(double bytes) {
    if (bytes < 1e4) return fmt::format("{:.0f} bytes", bytes);
    if (bytes < 1e6) return fmt::format("{:.1f} KB", bytes / kKb);
    return fmt::format("{:.1f} MB", bytes / (kKb * kKb));
}

std::string time_text(double ms) {
    constexpr double kS = 1e3, kMin = 60 * kS, kHour = 60 * kMin;
    if (ms < 10 * kS) return fmt::format("{:.1f} ms", ms);
    if (ms < 10 * kMin) return fmt::format("{:.1f} s", ms / kS);
    if (ms < 10 * kHour) return fmt::format("{:.1f} min", ms / kMin);
    return fmt::format("{:.1f} h", ms / kHour);
}

std::string rate_text(double rays_per_s) {
    if (rays_per_s >= 1e6) return fmt::format("{:.1f} Mrays/s", rays_per_s * 1e-6);
    if (rays_per_s >= 1e3) return fmt::format("{:.1f} krays/s", rays_per_s * 1e-3);
    return fmt::format("{:.1f} rays/s", rays_per_s);
}

}  // namespace raya
