#include "host/report/page/page.hpp"

#include <algorithm>

#include "host/base/encoding.hpp"
#include "host/embedded.hpp"

namespace raya {
namespace {

const std::string& asset(const std::string& name) { return embedded_files().at("host/report/page/" + name); }

// Escapes <, > and &, so that the browser finds no tag or entity in a string. JSON has them only in strings.
std::string escape_tags(std::string json) {
    for (const auto& [sign, escape] : {std::pair{"<", "\\u003c"}, {">", "\\u003e"}, {"&", "\\u0026"}})
        json = replaced(std::move(json), sign, escape);
    return json;
}

// Replaces every {{NAME}} in `text` by the asset NAME, and {{report}} by the report. Does not search inserted text.
std::string fill_template(const std::string& text, const Json& report) {
    std::string page;
    std::size_t text_begin = 0;  // start of the text that is not copied yet
    for (std::size_t at = text.find("{{"); at != std::string::npos; at = text.find("{{", text_begin)) {
        const std::size_t end = text.find("}}", at);
        const std::string name = text.substr(at + 2, end - at - 2);
        page += text.substr(text_begin, at - text_begin) +
                (name == "report" ? escape_tags(json_dump(report, 2)) : asset(name));
        text_begin = end + 2;
    }
    return page + text.substr(text_begin);
}

}  // namespace

std::string report_page(const Json& report) { return fill_template(asset("page.html"), report); }

Json cost_json(const std::vector<std::uint64_t>& cycles) {
    const std::uint64_t maximum = cycles.empty() ? 0 : *std::ranges::max_element(cycles);
    std::uint32_t bytes = 1;
    while (bytes < 8 && maximum >> 8 * bytes != 0) ++bytes;
    GzipText gzip;
    std::string plane(cycles.size(), '\0');
    for (std::uint32_t byte = 0; byte < bytes; ++byte) {
        std::ranges::transform(cycles, plane.begin(),
                               [byte](std::uint64_t c) { return static_cast<char>(c >> 8 * byte & 0xff); });
        gzip.append(plane);
    }
    return {{"bytes", bytes}, {"gzip", base64(gzip.finish())}};
}

}  // namespace raya
