// Bisection, for the longest queue that fits.
#pragma once
#include <cstdint>

namespace raya {

/// The last number below `above` for which `holds` is true: it is for `first`, and of two numbers for the larger one
/// only if it is for the smaller.
template <class Holds>
std::uint32_t last_that_holds(std::uint64_t first, std::uint64_t above, const Holds& holds) {
    while (above - first > 1) {
        const std::uint64_t middle = first + (above - first) / 2;
        (holds(static_cast<std::uint32_t>(middle)) ? first : above) = middle;
    }
    return static_cast<std::uint32_t>(first);
}

}  // namespace raya
