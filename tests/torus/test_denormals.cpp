// Lanes without a packet compute with normal numbers, because denormals are slow (tests/ring/test_denormals.cpp).
#include <catch2/catch.hpp>

#include "tests/kernels/denormals.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

TEST_CASE("no lane of the torus's kernels computes with denormals", "[.][denormals]") {
    REQUIRE(can_detect_denormals());
    Session session(choose_device(""));
    for (const std::string& name : quick<std::string>(1, {"every kind", "glass", "polygons", "cones"})) {
        CAPTURE(name);
        TorusCase c;
        c.sources.more_options = {"-cl-opt-disable"};
        TorusRenderer renderer(session, name == "every kind" ? random_view_scene(1) : project_scene(name),
                               settings_of(c));
        renderer.render();  // PoCL compiles the kernels in the first render
        CHECK_FALSE(uses_denormals([&] { renderer.render(); }));
    }
}

}  // namespace
}  // namespace raya
