#include "host/model/unit_text.hpp"

#include <fmt/core.h>

namespace raya {
namespace {

constexpr std::uint64_t kKb = 1024;

std::string tenths_text(std::uint64_t tenths) { return fmt::format("{}.{} KB", tenths / 10, tenths % 10); }

}  // namespace

std::string counted(std::uint64_t count, const std::string& singular, const std::string& plural) {
    return fmt::format("{} {}", count, count == 1 ? singular : plural.empty() ? singular + 's' : plural);
}

std::string required_size_text(std::uint64_t bytes) {
    return bytes < kKb ? fmt::format("{} bytes", bytes) : tenths_text((10 * bytes + kKb - 1) / kKb);
}

std::string available_size_text(std::uint64_t bytes) {
    if (bytes < kKb) return fmt::format("{} bytes", bytes);
    return bytes % kKb == 0 ? fmt::format("{} KB", bytes / kKb) : tenths_text(10 * bytes / kKb);
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
