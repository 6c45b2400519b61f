// The explorer's page as a file: what is in it, what is refused.
#include <catch2/catch.hpp>

#include "host/error.hpp"
#include "host/explore/cost_bytes.hpp"
#include "host/explore/explorer.hpp"
#include "host/explore/figures.hpp"
#include "host/page/html_document.hpp"
#include "tests/base/gunzip.hpp"
#include "tests/explore/random_settings.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;

Exploration exploration(CostImage cost) {
    const std::uint32_t width = cost.width, height = cost.height;
    std::vector<float> rgb(std::size_t{3} * width * height, 0.5f);
    return {.scene = "a <b>.nff",
            .command = "raya render 'a <b>.nff' -o image.png",
            .settings = "spa, e6m15, 8 bounces",
            .made = "Made by a test.",
            .machine = machine_named("spa"),
            .mapping = make_mapping(cyclic_mapping(1 % width), {width, height}, width),
            .cost = std::move(cost),
            .image = {static_cast<int>(width), static_cast<int>(height), std::move(rgb)}};
}

TEST_CASE("costs come back from their bytes", "[explore]") {
    RandomSettings random(7);
    for (const int bits : {0, 1, 7, 8, 9, 16, 31, 33, 52}) {
        const CostImage cost = random.costs(19, 11, bits, false);
        const std::string bytes = gunzip(cost_bytes(cost));
        const std::size_t pixels = cost.cycles.size(), planes = bytes_of_cost(cost);
        REQUIRE(bytes.size() == pixels * planes);
        for (std::size_t at = 0; at < pixels; ++at) {
            std::uint64_t cycles = 0;
            for (std::size_t plane = planes; plane-- > 0;)
                cycles = cycles << 8 | static_cast<std::uint8_t>(bytes[plane * pixels + at]);
            if (cycles != cost.cycles[at]) FAIL("pixel " << at << ", " << bits << " bits");
        }
    }
}

TEST_CASE("the page says the figures of the setting that it opens with, in itself", "[explore]") {
    RandomSettings random(8);
    const Exploration e = exploration(random.costs(24, 16, 18));
    const std::string html = explorer_html(e);
    for (const auto& [name, text] : figure_texts(figures_of(e.cost, e.mapping, e.machine)))
        CHECK_THAT(html, Contains("<dd data-figure=\"" + name + "\">" + text + "</dd>"));
    CHECK_THAT(html, Contains("<title>raya explore: a &lt;b&gt;.nff</title>") && !Contains("a <b>"));
    CHECK_THAT(html, !Contains("{{") && !Contains("http:") && !Contains("https:"));
    CHECK_THAT(html, Contains("default-src 'none'") && Contains("<noscript>"));
    CHECK(html == explorer_html(e));  // the same every time
}

TEST_CASE("a page that would be too large is refused, and so are cycles that no page adds up", "[explore]") {
    RandomSettings random(9);
    Exploration large = exploration(random.costs(700, 700, 33, false));
    CHECK_THROWS_WITH(explorer_html(large), Contains("1000000 at most") && Contains("remedy: --size 4"));
    CHECK_NOTHROW(check_explorable({1000, 2000}));
    CHECK_THROWS_WITH(check_explorable({2001, 1000}), Contains("--size 2001x1000: too many pixels"));
    Exploration dear = exploration({2, 1, {kExactCycles - 1, 0}});
    CHECK(explorer_html(dear).size() < kLargestPage);
    dear.cost.cycles[1] = 1;
    CHECK_THROWS_WITH(explorer_html(dear), Contains("more than a page adds up exactly"));
}

}  // namespace
}  // namespace raya
