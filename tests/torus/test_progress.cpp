// Progress reports of torus renders.
#include <catch2/catch.hpp>
#include <vector>

#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

TEST_CASE("the torus reports progress per superstep, and 1 only after the last", "[torus]") {
    Session session(choose_device(""));
    const TorusCase c{.width = 24, .height = 24, .nodes = {2, 2, 2}, .lanes = 4, .group = 1};
    for (const Injection inject : {Injection::kAll, Injection::kRoot}) {
        TorusCase settings = c;
        settings.inject = inject;
        TorusRenderer renderer(session, project_scene("centre"), settings_of(settings));
        std::vector<double> fractions;
        const TorusResult result = renderer.render([&](double done) { fractions.push_back(done); });
        REQUIRE(fractions.size() == result.supersteps.size());
        CHECK(fractions.back() == 1);
        for (std::size_t i = 0; i + 1 < fractions.size(); ++i) {
            CAPTURE(i, fractions.size());
            CHECK(fractions[i] < 1);
        }
        for (const double position : {0.3, 0.5, 0.7, 0.9}) {  // fraction of the supersteps that are done
            CAPTURE(position);
            CHECK(fractions[static_cast<std::size_t>(position * static_cast<double>(fractions.size()))] ==
                  Approx(position).margin(0.25));
        }
    }
}

}  // namespace
}  // namespace raya
