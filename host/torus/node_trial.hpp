// The same job on larger torus machines, for the remedy of a refusal.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "host/accel/partition.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"

namespace raya {

/// The same job on another number of nodes: words of its fullest node, and into which voxels the box was cut.
struct TrialNodes {
    std::uint64_t words = 0;
    Divisions voxels{};
};
using NodeTrial = std::function<std::optional<TrialNodes>(const std::array<std::uint32_t, 3>& nodes)>;

/// A trial that doubles `voxels` along each axis until every node has one; empty where the scene cannot be cut up so
/// far. It refers to the job.
NodeTrial trial_of(const PackedJob& job, const NumberFormat& format, const Divisions& voxels);

}  // namespace raya
