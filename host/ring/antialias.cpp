#include "ring/antialias.hpp"

#include <fmt/format.h>

#include <array>

#include "error.hpp"

namespace raya {
namespace {

// In the order of AntialiasMethod.
constexpr std::array<const char*, 3> kMethods = {"none", "filter", "supersample"};

}  // namespace

AntialiasMethod parse_antialias(const std::string& text) {
    for (std::size_t i = 0; i < kMethods.size(); ++i)
        if (text == kMethods[i]) return static_cast<AntialiasMethod>(i);
    throw UserError(fmt::format("--antialias {}: must be none, filter or supersample", text));
}

std::string antialias_name(AntialiasMethod method) { return kMethods.at(static_cast<std::size_t>(method)); }

raya_u32 parse_points(const std::string& text) {
    if (text == "axes") return RAYA_POINTS_AXES;
    if (text == "diagonals") return RAYA_POINTS_DIAGONALS;
    throw UserError(fmt::format("--points {}: must be axes or diagonals", text));
}

std::string points_name(raya_u32 points) { return points == RAYA_POINTS_DIAGONALS ? "diagonals" : "axes"; }

}  // namespace raya
