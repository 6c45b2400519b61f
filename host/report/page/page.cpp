#include "host/report/page/page.hpp"

#include <algorithm>
#include <initializer_list>
#include <regex>

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

// Returns the functions of kernels/shared/ that compute the owner of a pixel, as JavaScript, whose numbers represent
// all their values exactly: products are below 2^53, except those with the constants of raya_mix(), which need
// Math.imul.
std::string owner_functions() {
    const std::string mapping = embedded_files().at("kernels/shared/mapping.h");
    std::string text = embedded_files().at("kernels/shared/scramble.h") +
                       mapping.substr(0, mapping.find("// Returns the share of a PE."));
    for (const auto& [pattern, replacement] : std::initializer_list<std::pair<const char*, const char*>>{
             {R"(typedef struct \{[^}]*\} \w+;|RAYA_SHARED_SIZE\([^)]*\);)", ""},
             {R"(#define (\w+) (\d+)u\b)", "const $1 = $2;"},
             {R"(#[^\n]*)", ""},
             {R"(RAYA_SHARED_FUNCTION \w+ )", "function "},
             {R"(\(raya_u(32|64)\))", ""},
             {R"(for \(raya_u32 )", "for (let "},
             {R"(const raya_u32 )", "const "},
             {R"((\(|, )raya_(u32|mapping) )", "$1"},
             {R"(\braya_u32 (\w+ =))", "let $1"},
             {R"(\b(0x[0-9a-f]+|\d+)u\b)", "$1"},
             {R"(>>)", ">>>"},
             {R"((\([^()]*\)) \* (0x\w+))", "Math.imul($1, $2)"},
             {R"((\w+ \* \w+|[\w.]+|\([^()]*\)) / ([\w.]+))", "Math.floor($1 / $2)"}})
        text = std::regex_replace(text, std::regex(pattern), replacement);
    return text;
}

// Replaces every {{NAME}} in `text` by the asset NAME, {{mapping.js}} by owner_functions(), and {{report}} by the
// report. Does not search inserted text.
std::string fill_template(const std::string& text, const Json& report) {
    std::string page;
    std::size_t text_begin = 0;  // start of the text that is not copied yet
    for (std::size_t at = text.find("{{"); at != std::string::npos; at = text.find("{{", text_begin)) {
        const std::size_t end = text.find("}}", at);
        const std::string name = text.substr(at + 2, end - at - 2);
        page += text.substr(text_begin, at - text_begin) + (name == "report"       ? escape_tags(json_dump(report, 2))
                                                            : name == "mapping.js" ? owner_functions()
                                                                                   : asset(name));
        text_begin = end + 2;
    }
    return page + text.substr(text_begin);
}

}  // namespace

std::string report_page(const Json& report) { return fill_template(asset("page.html"), report); }

void members_of(Members& m, const CostPlanes& cost) {
    m("bytes", cost.bytes, "Number of bytes of a cost: the number that the largest cost needs.");
    m("gzip", base64(cost.gzip),
      "Gzip file in base64: the lowest byte of all costs, then the next byte of all costs, and so on.");
}

CostPlanes cost_planes(const std::vector<std::uint64_t>& cycles) {
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
    return {bytes, gzip.finish()};
}

}  // namespace raya
