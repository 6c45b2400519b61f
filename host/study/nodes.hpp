// The torus machine from one node to thousands: speed-up, balance, ways, on two and on three dimensions.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/study/page.hpp"
#include "host/study/scenes.hpp"

namespace raya {

struct NodesSettings {
    std::uint32_t size = 64;    // pixels a side
    std::uint32_t most = 4096;  // nodes, a power of two
    std::uint32_t sides = 16;   // voxels along each axis, where all machines have the same ones
    /// A series ends before a machine of which this many launches of a node are to be feared: supersteps x nodes.
    std::uint64_t most_launches = std::uint64_t{1} << 22;
};

/// `scenes`: one at least.
StudyPage nodes_page(Session& session, const std::vector<LabelledScene>& scenes, const NodesSettings& settings);

}  // namespace raya
