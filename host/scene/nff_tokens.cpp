#include "host/scene/nff_tokens.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <system_error>
#include <utility>

#include "host/error.hpp"

namespace raya {
namespace {

constexpr std::string_view kDirective = "#raya";

enum class CharKind : std::uint8_t { kText, kBlank, kLineEnd, kHash, kBinary };

constexpr std::array<CharKind, 256> kCharKinds = [] {
    std::array<CharKind, 256> kinds{};
    for (std::size_t c = 0; c < ' '; ++c) kinds[c] = CharKind::kBinary;
    kinds[0x7f] = CharKind::kBinary;
    for (const char c : {' ', '\t', '\v', '\f'}) kinds[static_cast<std::size_t>(c)] = CharKind::kBlank;
    for (const char c : {'\r', '\n'}) kinds[static_cast<std::size_t>(c)] = CharKind::kLineEnd;
    kinds['#'] = CharKind::kHash;
    return kinds;
}();

CharKind kind_of(char c) { return kCharKinds[static_cast<unsigned char>(c)]; }

bool is_blank(char c) { return kind_of(c) == CharKind::kBlank || kind_of(c) == CharKind::kLineEnd; }

struct ParsedNumber {
    double value = 0;
    std::string_view rest;  // remaining characters after the number
    std::errc error{};
};

/// Parses the number at the start of a text with std::from_chars, which ignores the locale. Removes a leading '+'
/// first, because std::from_chars rejects it, while scanf and therefore other NFF readers accept it.
ParsedNumber parsed_number(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    ParsedNumber number;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number.value);
    number.rest = text.substr(static_cast<std::size_t>(end - text.data()));
    number.error = error;
    return number;
}

}  // namespace

bool reads_as_number(std::string_view text) { return parsed_number(text).error != std::errc::invalid_argument; }

std::string in_quotes(std::string_view text) {
    constexpr std::size_t kShown = 24;
    std::string shown = "'";
    for (const char c : text.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown + (text.size() > kShown ? "...'" : "'");
}

NffTokens::NffTokens(std::string_view text, std::string name, int first_line)
    : text_(text), name_(std::move(name)), line_(first_line) {
    if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
    advance();
}

void NffTokens::refuse(int line, std::string_view reason) const {
    throw UserError(fmt::format("{}:{}: {}", name_, line, reason));
}

bool NffTokens::is_at_directive() const {
    const std::string_view rest = text_.substr(position_);
    if (!rest.starts_with(kDirective)) return false;
    return rest.size() == kDirective.size() || is_blank(rest[kDirective.size()]);
}

void NffTokens::refuse_binary() const {
    refuse(line_, "a control character: is this a binary file? NFF is plain text");
}

void NffTokens::skip_blanks_and_comments() {
    bool comment = false;
    for (; position_ < text_.size(); ++position_) {
        switch (kind_of(text_[position_])) {
            case CharKind::kBinary:
                refuse_binary();
            case CharKind::kLineEnd: {
                const bool is_cr_of_crlf =
                    text_[position_] == '\r' && position_ + 1 < text_.size() && text_[position_ + 1] == '\n';
                line_ += is_cr_of_crlf ? 0 : 1;
                at_line_start_ = true;
                comment = false;
                break;
            }
            case CharKind::kHash:
                if (comment) break;
                if (is_at_directive()) {
                    if (at_line_start_) return;
                    refuse(line_, "'#raya' must be the first word of its line");
                }
                comment = true;
                break;
            case CharKind::kText:
                if (!comment) return;
                break;
            case CharKind::kBlank:
                break;
        }
    }
}

void NffTokens::advance() {
    skip_blanks_and_comments();
    const std::size_t start = position_;
    if (position_ < text_.size()) ++position_;
    while (position_ < text_.size() && kind_of(text_[position_]) == CharKind::kText) ++position_;
    if (position_ < text_.size() && kind_of(text_[position_]) == CharKind::kBinary) refuse_binary();
    next_ = {text_.substr(start, position_ - start), line_, at_line_start_};
    at_line_start_ = false;
}

void NffTokens::start_at(std::size_t position) {
    position_ = position;
    line_ = 1;
    at_line_start_ = true;
    advance();
}

void NffTokens::continue_after(const NffTokens& piece) {
    const int lines = next_.line - 1;  // before the piece
    position_ = piece.position_;
    line_ = piece.line_ + lines;
    at_line_start_ = piece.at_line_start_;
    next_ = piece.next_;
    next_.line += lines;
    entity_ = piece.entity_;
    entity_line_ = piece.entity_line_ + lines;
    one_line_ = piece.one_line_;
}

std::string_view NffTokens::take_keyword() {
    const NffToken keyword = next_;
    if (!keyword.first_on_line)
        refuse(keyword.line, fmt::format("{} follows the end of {}; a new entity starts on a new line",
                                         in_quotes(keyword.text), in_quotes(entity_)));
    entity_ = keyword.text;
    entity_line_ = keyword.line;
    one_line_ = keyword.text == kDirective;
    advance();
    return keyword.text;
}

NffToken NffTokens::take_part(std::string_view what) {
    const NffToken token = next_;
    if (token.text.empty()) refuse(token.line, fmt::format("the file ends before {} of {}", what, in_quotes(entity_)));
    if (one_line_ && token.line != entity_line_)
        refuse(entity_line_, fmt::format("the line ends before {} of {}", what, in_quotes(entity_)));
    advance();
    return token;
}

std::string_view NffTokens::take_name(std::string_view what) {
    const NffToken token = take_part(what);
    if (one_line_) entity_ += fmt::format(" {}", token.text);
    return token.text;
}

bool NffTokens::skip_unknown() {
    const std::size_t at = position_ - next_.text.size();
    const std::string_view line = text_.substr(at, text_.find_first_of("\r\n", at) - at);
    if (!reads_as_entity(entity_, next_.first_on_line ? std::string_view() : line)) return false;
    while (!next_.text.empty() && (!next_.first_on_line || number_follows())) advance();
    return true;
}

bool NffTokens::number_follows() const { return reads_as_number(next_.text); }

double NffTokens::take_number(std::string_view what, double max) {
    const ParsedNumber number = parsed_number(next_.text);
    const bool is_not_number = number.error == std::errc::invalid_argument;
    const bool incomplete = is_not_number && next_.first_on_line && !one_line_;
    const NffToken token = take_part(what);
    const auto refuse_token = [&](std::string_view reason) {
        refuse(token.line, fmt::format("{} of {}: {} {}", what, in_quotes(entity_), in_quotes(token.text), reason));
    };
    if (incomplete)
        refuse(token.line, fmt::format("{} of line {} is incomplete: expected {}, found {}", in_quotes(entity_),
                                       entity_line_, what, in_quotes(token.text)));
    if (is_not_number) refuse_token("is not a number");
    if (number.error == std::errc::result_out_of_range) refuse_token("is outside the range of double precision");
    if (!number.rest.empty()) refuse_token("has characters after the number");
    if (!std::isfinite(number.value)) refuse_token("is not a finite number");
    if (std::abs(number.value) > max) refuse_token(fmt::format("is out of range: at most {:.0e} in magnitude", max));
    return number.value;
}

int NffTokens::take_integer(std::string_view what, int lowest, int highest) {
    const int line = next_.line;
    const double value = take_number(what, std::numeric_limits<double>::infinity());
    if (value != std::floor(value) || value < lowest || value > highest)
        refuse(line, fmt::format("{} of {} is {}: must be a whole number from {} to {}", what, in_quotes(entity_),
                                 value, lowest, highest));
    return static_cast<int>(value);
}

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
