// Cases and patterns for the checks of the machines: drawn by lot with a fixed seed, the ends of the ranges among them.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/torus/topology.hpp"
#include "kernels/shared/mapping.h"
#include "kernels/shared/neighbours.h"

namespace raya {

/// `count` legal mappings of a kind (RAYA_FOLD_CYCLIC..RAYA_RANDOM), up to the largest images and arrays, and a pixel
/// of each.
std::pair<std::vector<raya_mapping>, std::vector<raya_pixel>> mapping_cases(std::uint32_t kind, std::size_t count);

/// `count` toruses of either kind, and two nodes of each: [case][2].
std::pair<std::vector<raya_torus>, std::vector<std::uint32_t>> torus_cases(std::size_t count);

}  // namespace raya
