// Patches the number layer to simulate a device whose division has errors of up to 2 units in the last place, and whose
// square root has errors of up to 3 units.
#pragma once
#include "tests/number/number_runs.hpp"

namespace raya {

/// Returns patches for builds with RAYA_EXACT_DIVIDE=0. They add an error, which depends on the operands' bits, to
/// results that are normal numbers.
inline std::vector<SourcePatch> erring_device_patches() {
    const std::string file = "number/divide.clh", before = "// The neighbour of z whose bits are";
    const std::string functions = R"(
static inline real with_error(real z, mask bits, int max_error) {
    const count mixed = as_lanes_uint(bits) * 2654435761u;
    const mask step = as_lanes_int((mixed >> 16) % (count)(2 * max_error + 1)) - max_error;
    const mask normal = (fabs(z) > 0x1p-126f) & (fabs(z) < INFINITY);
    return choose(normal, as_lanes_real(as_lanes_int(z) + step), z);
}
)";
    return {{file, before, functions + before},
            {file, "real z = a / b;", "real z = with_error(a / b, as_lanes_int(a) ^ (as_lanes_int(b) >> 1), 2);"},
            {file, "real z = sqrt(x);", "real z = with_error(sqrt(x), as_lanes_int(x), 3);"}};
}

/// Returns a build for the simulated device, in which the number layer refines divisions and square roots.
inline NumberBuild refined_build(const NumberFormat& format, std::uint32_t lanes = widest_lanes()) {
    return {.format = format, .lanes = lanes, .trusted = false, .sources = {.patches = erring_device_patches()}};
}

}  // namespace raya
