// Small random torus machines for tests. Sides of one or two nodes are frequent.
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

/// Returns three random sides of 1..`max_side` nodes. On average, at least a quarter of the sides have one node. The
/// links along such a side lead back to the same node.
inline std::array<std::uint32_t, 3> random_sides(SplitMix& random, std::uint32_t max_side) {
    const auto side = [&] { return random.next() % 4 == 0 ? 1 : 1 + random_below(random, max_side); };
    const std::uint32_t first = side(), second = side();
    return {first, second, side()};
}

/// Returns a random torus of up to `max_side` nodes along each axis, with 2-D or 3-D links.
inline raya_torus random_torus(SplitMix& random, std::uint32_t max_side) {
    const Links links = random.next() % 2 ? Links::kTorus3d : Links::kTorus2d;
    return make_torus(random_sides(random, max_side), links);
}

/// Returns the nodes and the sides of a torus as text for failure messages: "3x4x6 on 6x12x1".
inline std::string torus_text(const raya_torus& t) {
    return sides_text({t.nodes[0], t.nodes[1], t.nodes[2]}) + " on " + sides_text({t.sides[0], t.sides[1], t.sides[2]});
}

/// Returns the message of the UserError that `call` throws, or "no error" if it throws none.
inline std::string user_error_message(const std::function<void()>& call) {
    try {
        call();
    } catch (const UserError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace raya
