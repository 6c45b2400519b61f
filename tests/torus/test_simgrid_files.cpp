// Files for SimGrid, compared with hand-written text.
#include <catch2/catch.hpp>

#include "host/torus/async_machine.hpp"
#include "tests/torus/random_history.hpp"

namespace raya {
namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t number = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++number;
    return number;
}

TEST_CASE("a platform has a host per node, two one-way links and a wire per link, and neighbour routes", "[torus]") {
    for (const Links links : {Links::kTorus3d, Links::kTorus2d}) {
        const raya_torus torus = make_torus({4, 4, 4}, links);
        const std::size_t neighbour_pairs = 64 * links_of_node(torus);
        const std::string xml = simgrid_platform(torus, {});
        CHECK(count_of(xml, "<host id=") == 64);
        CHECK(count_of(xml, "bandwidth=\"1700000Bps\"") == neighbour_pairs);
        CHECK(count_of(xml, "bandwidth=\"2400000Bps\"") == neighbour_pairs / 2);
        CHECK(count_of(xml, "<route src=") == neighbour_pairs);
        CHECK_THAT(xml, Catch::Contains(links == Links::kTorus2d ? "<route src=\"0\" dst=\"7\""
                                                                 : "<route src=\"0\" dst=\"3\""));
        for (const char* part : {"<host id=\"63\" speed=\"25000000f\"/>", "<link_ctn id=\"0-x\"/><link_ctn id=\"wire "})
            CHECK_THAT(xml, Catch::Contains(part));
    }
    // On a side of 2 nodes, two links join the nodes, one in each direction round the side. Each link has a separate
    // wire.
    const std::string two_nodes = simgrid_platform(make_torus({2, 1, 1}, Links::kTorus3d), {.one_way = 0});
    CHECK(count_of(two_nodes, "<route src=") == 2);
    CHECK_THAT(two_nodes, Catch::Contains("\"0+x\"/><link_ctn id=\"wire 0+x\"") &&
                              Catch::Contains("\"1+x\"/><link_ctn id=\"wire 1+x\"") && !Catch::Contains("2400000"));
}

TEST_CASE("a replay file has tasks, their causes, and the routes of messages", "[torus]") {
    HistoryBuilder h;
    h.add_task(2, 500);
    const std::uint32_t ray = h.add_ray(0), message_to_sender = h.add_ray(2);
    h.add_task(0, 7, ray);
    h.add_task(2, 9, message_to_sender);
    h.add_return();
    CHECK(simgrid_replay(make_torus({3, 1, 1}, Links::kTorus3d), h.history, {.buffer = 3}) ==
          "machine 3 3 2 19 2\nt 2 500 -\nm 16 1 0 0\nm 16 1\nt 0 7 0\nt 2 9 1\nm 8 0 0 0\n");
}

}  // namespace
}  // namespace raya
