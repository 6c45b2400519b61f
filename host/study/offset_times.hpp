// What every offset of the cyclic mapping takes on the SPA, from one cost image: computing and rotations together.
#pragma once
#include <cstdint>
#include <vector>

#include "host/ring/antialias.hpp"
#include "host/scene/scene.hpp"
#include "host/study/laboratory.hpp"

namespace raya {

/// Modelled milliseconds of one offset, no factor. Broadcast and gather are not in it: they take the same for every
/// offset.
struct OffsetTime {
    std::uint32_t offset = 0;
    double imbalance = 0;       // u of the first pass
    double trace_ms = 0;        // of the busiest PE in the first pass
    double smooth_ms = 0;       // means or comparisons
    double supersample_ms = 0;  // of the busiest PE in supersampling
    double ring_ms = 0;
    std::uint64_t rotations = 0;

    double total_ms() const { return trace_ms + smooth_ms + supersample_ms + ring_ms; }
};

/// Rotations that bring each PE its neighbours' pixels once from each side: those of NeighbourExchange, where whole
/// shares go round.
std::uint64_t neighbour_rotations(const raya_mapping& mapping);

/// Of the offsets 0..W-1, cyclic fold. `costs.supersample` may be empty where the method is another. The PEs have room
/// for the shares that go round. Takes O(W pixels).
std::vector<OffsetTime> offset_times(const Costs& costs, std::uint32_t pes, AntialiasMethod method);

/// Pixels a side of the image in which a scene's offsets are compared, unless asked for: the scene's own size where it
/// is square, else 256, halved while the scene's objects would make it take minutes.
std::uint32_t usual_size(const Scene& scene);

}  // namespace raya
