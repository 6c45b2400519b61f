#pragma once
#include <cstdint>

#include "host/scene/split_mix.hpp"

namespace raya {

/// Returns a random integer in [0, end).
inline std::uint32_t random_below(SplitMix& random, std::uint64_t end) {
    return static_cast<std::uint32_t>(random.next() % end);
}

}  // namespace raya
