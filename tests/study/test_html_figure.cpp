// Drawings within the studies' document.
#include <catch2/catch.hpp>

#include "host/study/html_figure.hpp"

namespace raya {
namespace {

TEST_CASE("a drawing comes in without its head, in colours that may change", "[html]") {
    CHECK(
        inlined_svg("<?xml?><!DOCTYPE svg>\n<svg a=\"b\"><g style=\"fill: #0072b2; stroke: #ffffff\" href=\"#abcdef\" "
                    "clip-path=\"url(#abcdef)\"/>: #12 </svg>\n") ==
        "<svg a=\"b\"><g style=\"fill: var(--plot-0072b2, #0072b2); stroke: var(--plot-ffffff, #ffffff)\" "
        "href=\"#abcdef\" clip-path=\"url(#abcdef)\"/>: #12 </svg>\n");
    CHECK(inlined_svg("no drawing") == "");
    CHECK(inlined_svg("<svg> cut off") == "");
}

}  // namespace
}  // namespace raya
