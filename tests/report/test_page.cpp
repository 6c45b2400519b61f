// Tests of the page of a report: the embedded report is unchanged, and the browser does not interpret text of the
// report as HTML.
#include <catch2/catch.hpp>

#include "host/report/page/page.hpp"
#include "tests/base/gunzip.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

// Returns the content of <pre id="report">, which must contain no HTML entities.
std::string report_in(const std::string& page) {
    const std::string begin = "<pre id=\"report\" tabindex=\"0\">";
    const std::size_t start = page.find(begin) + begin.size();
    return page.substr(start, page.find("</pre>", start) - start);
}

TEST_CASE("report_page: embeds the report unchanged, whatever its texts contain", "[page]") {
    const std::string hostile =
        "</pre></script><script>x()</script><img src=x onerror=x()>&lt;&amp;{{style.css}}{{report}}<!--\u2028'\"`\\\n";
    const Json report = {
        {"kind", "raya render"}, {"scene", hostile}, {hostile, 1.5}, {"list", Json(std::vector<std::string>{hostile})}};
    const std::string page = report_page(report), inside = report_in(page);
    CHECK(inside.find_first_of("<>&") == std::string::npos);
    CHECK(Document::parse(inside) == Document::parse(report.dump()));
    CHECK(page == report_page(report));
}

TEST_CASE("report_page: makes one file that loads no resources", "[page]") {
    const std::string page = report_page({{"kind", "raya render"}});
    CHECK_THAT(page, StartsWith("<!doctype html>"));
    CHECK_THAT(page, Contains("default-src 'none'") && Contains("<noscript>"));
    CHECK_THAT(page, !Contains("{{") && !Contains("src=\"") && !Contains("https:"));
    CHECK(page.size() < 150'000);
}

// Decodes base64.
std::string decoded(const std::string& base64) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    std::uint32_t word = 0, bits = 0;
    for (const char c : base64.substr(0, base64.find('='))) {
        word = word << 6 | static_cast<std::uint32_t>(digits.find(c));
        if ((bits += 6) >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 0xff);
    }
    return bytes;
}

TEST_CASE("cost_planes: the cycles can be decoded exactly", "[page]") {
    for (const std::uint32_t bits : {0u, 1u, 7u, 8u, 9u, 16u, 31u, 33u, 52u, 64u}) {
        std::vector<std::uint64_t> cycles = {0, bits == 0 ? 0 : ~std::uint64_t{0} >> (64 - bits)};
        for (std::uint64_t i = 0; i < 209; ++i) cycles.push_back(bits == 0 ? 0 : i * 0x9e3779b97f4a7c15 >> (64 - bits));
        const Json json = to_json(cost_planes(cycles));
        const std::string bytes = gunzip(decoded(json_text(json.at("gzip"))));
        const std::size_t pixels = cycles.size(), byte_planes = json_integer(json.at("bytes"));
        CAPTURE(bits);
        CHECK(byte_planes == std::max(1u, (bits + 7) / 8));
        REQUIRE(bytes.size() == pixels * byte_planes);
        for (std::size_t at = 0; at < pixels; ++at) {
            std::uint64_t found = 0;
            for (std::size_t plane = byte_planes; plane-- > 0;)
                found = found << 8 | static_cast<std::uint8_t>(bytes[plane * pixels + at]);
            REQUIRE(found == cycles[at]);
        }
    }
}

}  // namespace
}  // namespace raya
