// How the image is smoothed after the first pass (Kohata & Ito 1993, anti-aliasing).
#pragma once
#include <string>

#include "host/model/time_model.hpp"
#include "host/ring/route.hpp"
#include "kernels/shared/neighbours.h"

namespace raya {

enum class AntialiasMethod {
    kNone,
    kFilter,      // every pixel becomes the mean of its 3 x 3 neighbourhood
    kSupersample  // pixels that differ from a neighbour become the mean of five points
};

struct Antialias {
    AntialiasMethod method = AntialiasMethod::kNone;
    double threshold = 0.125;                   // of the difference in a colour, 0..1; supersampling
    raya_u32 points = RAYA_POINTS_AXES;         // RAYA_POINTS_AXES or _DIAGONALS; supersampling
    ExchangeWay exchange = ExchangeWay::kRing;  // how neighbours' pixels come
};

/// "none", "filter", "supersample"
std::string antialias_name(AntialiasMethod method);

/// Throws UserError where the mapping leaves no neighbours to be had by turning the ring.
void check_antialias(AntialiasMethod method, const raya_mapping& mapping, bool dynamic);

/// "axes", "diagonals", of RAYA_POINTS_*
std::string points_name(raya_u32 points);

/// Moves of ring or bus that bring neighbours' pixels from each side, where whole shares move. The filter's sums have
/// an order, comparisons have none.
MovesOfSides smoothing_moves(const Antialias& antialias, const raya_mapping& mapping);

/// Cycles that a PE whose share has `share` pixels spends on the method's arithmetic between neighbours.
SmoothingCycles smoothing_cycles(AntialiasMethod method, std::uint64_t share);

}  // namespace raya
