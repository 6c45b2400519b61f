#include "host/ring/antialias.hpp"

#include <fmt/core.h>

#include <array>

#include "host/error.hpp"
#include "host/model/budget.hpp"
#include "host/ring/mapping.hpp"

namespace raya {
namespace {

// Names of the methods, in the order of AntialiasMethod.
constexpr std::array<const char*, 3> kMethods = {"none", "filter", "supersample"};

}  // namespace

std::string antialias_name(AntialiasMethod method) { return kMethods.at(static_cast<std::size_t>(method)); }

void check_antialias(AntialiasMethod method, const raya_mapping& mapping, bool dynamic) {
    if (dynamic && method != AntialiasMethod::kNone)
        throw UserError(
            fmt::format("--antialias {} with a dynamic or hybrid --mapping: the owner of a neighbour is only known at "
                        "run time; use cyclic, column, rows, blocks, grid or tiles",
                        antialias_name(method)));
    if (method == AntialiasMethod::kNone || mapping.kind != RAYA_RANDOM) return;
    throw UserError(fmt::format(
        "--antialias {} with --mapping {}: the neighbours of a pixel are on random PEs of the ring; use cyclic, "
        "column, rows, blocks, grid or tiles",
        antialias_name(method), mapping_text(mapping)));
}

MovesOfSides smoothing_moves(const Antialias& antialias, const raya_mapping& mapping) {
    if (antialias.method == AntialiasMethod::kNone) return {};
    return exchange_moves(mapping, antialias.exchange, antialias.method == AntialiasMethod::kSupersample);
}

SmoothingCycles smoothing_cycles(AntialiasMethod method, std::uint64_t pixels) {
    SmoothingCycles cycles;
    if (method == AntialiasMethod::kFilter) cycles.filter = filter_cycles(pixels);
    if (method == AntialiasMethod::kSupersample) cycles.compare = compare_cycles(pixels);
    return cycles;
}

std::string points_name(raya_u32 points) { return points == RAYA_POINTS_DIAGONALS ? "diagonals" : "axes"; }

}  // namespace raya
