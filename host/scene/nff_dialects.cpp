#include "host/scene/nff_dialects.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "host/scene/nff.hpp"
#include "host/scene/nff_tokens.hpp"

namespace raya {
namespace {

constexpr std::string_view kBlanks = " \t\v\f", kLineEnds = "\r\n";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool reads_as_keyword(std::string_view token) {
    constexpr std::size_t kMaxLength = 8;
    return !token.empty() && token.size() <= kMaxLength && is_letter(token[0]) &&
           std::all_of(token.begin(), token.end(),
                       [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

/// Returns true if a dot or slash occurs before the last character, as in `wood.ppm`. A token that ends with a dot may
/// be the last word of a sentence.
bool reads_as_file(std::string_view token) {
    return token.substr(0, token.size() - 1).find_first_of("./") != token.npos;
}

bool opens_mail(std::string_view line) {
    const auto colon = std::find_if_not(line.begin(), line.end(), [](char c) { return is_letter(c) || c == '-'; });
    return line.starts_with("From ") || (colon - line.begin() > 1 && colon != line.end() && *colon == ':');
}

}  // namespace

bool reads_as_entity(std::string_view keyword, std::string_view rest) {
    constexpr int kMaxNames = 2;
    int numbers = 0, names = 0;
    rest = rest.substr(0, rest.find('#'));
    for (std::size_t at = 0; (at = rest.find_first_not_of(kBlanks, at)) != rest.npos;) {
        const std::string_view token = rest.substr(at, rest.find_first_of(kBlanks, at) - at);
        if (reads_as_number(token))
            ++numbers;
        else if (!reads_as_file(token))
            ++names;
        at += token.size();
    }
    return reads_as_keyword(keyword) && names <= (numbers > 0 ? kMaxNames : 0);
}

bool is_sense8_keyword(std::string_view token) {
    constexpr std::string_view kKeyword = "nff";
    return std::equal(token.begin(), token.end(), kKeyword.begin(), kKeyword.end(),
                      [](char c, char lower) { return is_letter(c) && (c | 0x20) == lower; });
}

std::string_view foreign_format(std::string_view text) {
    constexpr std::array kPovDirectives = {"#include", "#declare", "#version", "#macro", "#default", "//", "/*"};
    constexpr std::array kPovBlocks = {"camera", "light_source", "global_settings", "background", "sphere",
                                       "plane",  "box",          "union",           "object",     "mesh",
                                       "mesh2",  "sky_sphere"};
    constexpr std::array kObjKeywords = {"mtllib", "usemtl", "o", "g", "vn", "vt"};
    const auto contains = [](const auto& list, std::string_view token) { return std::ranges::count(list, token) > 0; };
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find_first_of(kLineEnds));
        const std::string_view token = line.substr(0, line.find_first_of(" \t\v\f{"));
        const std::string_view rest = line.substr(std::min(line.size(), token.size() + 1));
        if (token == "ply") return "a PLY";
        if (line.starts_with("glTF")) return "a glTF";
        if (line.starts_with('{') || line.starts_with('['))
            return text.find("\"asset\"") != text.npos && text.find("\"scenes\"") != text.npos ? "a glTF" : "a JSON";
        if (contains(kPovDirectives, token) || contains(kPovBlocks, token)) return "a POV-Ray";
        if (contains(kObjKeywords, token) || (token == "v" && reads_as_number(rest))) return "an OBJ";
        if (!line.empty() && line[0] != '#') return {};
        text.remove_prefix(std::min(text.size(), line.size() + 1));
    }
    return {};
}

MailHeader mail_header(std::string_view text) {
    const auto line_at = [&](std::size_t at) { return text.substr(at, text.find_first_of(kLineEnds, at) - at); };
    std::size_t at = std::min(text.find_first_not_of("\r\n \t\v\f"), text.size());
    if (!opens_mail(line_at(at))) return {};
    for (std::string_view line = line_at(at); line.find_first_not_of(kBlanks) != line.npos; line = line_at(at)) {
        at += line.size();
        at += text.substr(at).starts_with("\r\n") ? 2 : at < text.size() ? 1 : 0;
    }
    const std::string_view header = text.substr(0, at);
    const auto count_of = [&](char c) { return std::count(header.begin(), header.end(), c); };
    return {at, static_cast<int>(std::max(count_of('\n'), count_of('\r')))};
}

}  // namespace raya
