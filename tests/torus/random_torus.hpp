// Small torus machines for tests, with sides of one and two nodes more often than others.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "host/error.hpp"
#include "host/scene/split_mix.hpp"
#include "host/torus/topology.hpp"
#include "tests/scene/random_below.hpp"

namespace raya {

/// Three sides of 1..`largest`; every fourth is 1, where a torus has links that lead back to their own node.
inline std::array<std::uint32_t, 3> random_sides(SplitMix& random, std::uint32_t largest) {
    const auto side = [&] { return random.next() % 4 == 0 ? 1 : 1 + random_below(random, largest); };
    const std::uint32_t first = side(), second = side();
    return {first, second, side()};
}

/// Of either kind of links.
inline raya_torus random_torus(SplitMix& random, std::uint32_t largest) {
    const Links links = random.next() % 2 ? Links::kTorus3d : Links::kTorus2d;
    return make_torus(random_sides(random, largest), links);
}

/// What identifies a torus where a test fails: "3x4x6 on 6x12x1".
inline std::string torus_text(const raya_torus& t) {
    return sides_text({t.nodes[0], t.nodes[1], t.nodes[2]}) + " on " + sides_text({t.sides[0], t.sides[1], t.sides[2]});
}

/// The message of the UserError that a call throws.
inline std::string refusal_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const UserError& error) {
        return error.what();
    }
    return "not refused";
}

}  // namespace raya
