// Anti-aliasing methods, which are applied to the image after the first pass (Kohata & Ito 1993).
#pragma once
#include <string>

#include "host/model/time_model.hpp"
#include "host/ring/route.hpp"
#include "kernels/shared/neighbours.h"

namespace raya {

enum class AntialiasMethod {
    kNone,
    kFilter,      // mean of the 3 x 3 neighbourhood of every pixel
    kSupersample  // mean of five samples for each pixel that differs from a neighbour
};

struct Antialias {
    AntialiasMethod method = AntialiasMethod::kNone;
    double threshold = 0.125;            // supersampling: minimum colour difference that marks a pixel, 0..1
    raya_u32 points = RAYA_POINTS_AXES;  // supersampling: added samples, RAYA_POINTS_AXES or RAYA_POINTS_DIAGONALS
    ExchangeMethod exchange = ExchangeMethod::kRing;
};

/// Returns "none", "filter" or "supersample".
std::string antialias_name(AntialiasMethod method);

/// Throws UserError if the method needs neighbours and the mapping is dynamic or random. With such a mapping the
/// neighbours of a PE's pixels are not on PEs at a few fixed distances on the ring.
void check_antialias(AntialiasMethod method, const raya_mapping& mapping, bool dynamic);

/// Returns "axes" or "diagonals". `points`: RAYA_POINTS_AXES or RAYA_POINTS_DIAGONALS.
std::string points_name(raya_u32 points);

/// Returns, for each side, the number of ring or bus moves that bring the neighbouring pixels to every PE, if each move
/// carries a PE's whole share. The filter processes the sides one by one, as its rounded sums depend on the sides'
/// order. Supersampling compares the sides in any order, so that one series of broadcasts serves all sides.
MovesOfSides smoothing_moves(const Antialias& antialias, const raya_mapping& mapping);

/// Returns the modelled cycles of the method's arithmetic on neighbours, for a PE that owns `pixels` pixels.
SmoothingCycles smoothing_cycles(AntialiasMethod method, std::uint64_t pixels);

}  // namespace raya
