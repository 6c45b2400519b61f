// Progress reports of torus renders.
#include <catch2/catch.hpp>
#include <vector>

#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

TEST_CASE("the torus reports progress per superstep, and 1 only after the last", "[torus]") {
    Session session(choose_device(""));
    const TorusCase c{.width = 24, .height = 24, .nodes = {2, 2, 2}, .lanes = 4, .group = 1, .bounces = 8};
    for (const Injection inject : {Injection::kAll, Injection::kRoot}) {
        TorusCase one = c;
        one.inject = inject;
        TorusRenderer renderer(session, project_scene("centre"), settings_of(one));
        std::vector<double> shares;
        const TorusResult result = renderer.render([&](double done) { shares.push_back(done); });
        REQUIRE(shares.size() == result.supersteps.size());
        CHECK(shares.back() == 1);
        for (std::size_t i = 0; i + 1 < shares.size(); ++i) {
            CAPTURE(i, shares.size());
            CHECK(shares[i] < 1);
        }
        for (const double part : {0.3, 0.5, 0.7, 0.9}) {  // fraction of the supersteps
            CAPTURE(part);
            CHECK(shares[static_cast<std::size_t>(part * static_cast<double>(shares.size()))] ==
                  Approx(part).margin(0.25));
        }
    }
}

}  // namespace
}  // namespace raya
