// Anti-aliasing of the image after the first pass (Kohata & Ito 1993).
#pragma once
#include <string>

#include "host/model/time_model.hpp"
#include "host/ring/route.hpp"
#include "kernels/shared/neighbours.h"

namespace raya {

enum class AntialiasMethod {
    kNone,
    kFilter,      // mean of the 3 x 3 neighbourhood of every pixel
    kSupersample  // mean of five points for pixels that differ from a neighbour
};

struct Antialias {
    AntialiasMethod method = AntialiasMethod::kNone;
    double threshold = 0.125;            // difference of a colour component, 0..1; supersampling
    raya_u32 points = RAYA_POINTS_AXES;  // RAYA_POINTS_AXES or _DIAGONALS; supersampling
    ExchangeMethod exchange = ExchangeMethod::kRing;
};

/// "none", "filter", "supersample"
std::string antialias_name(AntialiasMethod method);

/// Throws UserError if the mapping is dynamic or random, so that neighbours are not in fixed PEs nearby.
void check_antialias(AntialiasMethod method, const raya_mapping& mapping, bool dynamic);

/// "axes" or "diagonals", for RAYA_POINTS_*
std::string points_name(raya_u32 points);

/// Moves of ring or bus that bring neighbours' pixels from each side, if whole shares move. The filter's sums depend on
/// the order of sides, comparisons do not.
MovesOfSides smoothing_moves(const Antialias& antialias, const raya_mapping& mapping);

/// Cycles of the method's arithmetic between neighbours, for a PE of `share` pixels.
SmoothingCycles smoothing_cycles(AntialiasMethod method, std::uint64_t share);

}  // namespace raya
