#include <algorithm>

#include "tests/fuzz/mutate.hpp"

namespace raya::fuzz {
namespace {

// A token or line of a text.
struct Piece {
    std::size_t start, size;
};

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

std::vector<Piece> tokens_of(const std::string& text) {
    std::vector<Piece> pieces;
    for (std::size_t at = 0; at < text.size();) {
        if (is_blank(text[at])) {
            ++at;
            continue;
        }
        const std::size_t start = at;
        while (at < text.size() && !is_blank(text[at])) ++at;
        pieces.push_back({start, at - start});
    }
    return pieces;
}

std::vector<Piece> lines_of(const std::string& text) {
    std::vector<Piece> pieces;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
        pieces.push_back({at, end - at});
        at = end;
    }
    return pieces;
}

// Valid and invalid numbers, many at the limits of double, float, the integer types and the readers.
const char* const kNumbers[] = {"0",          "-0",
                                "1",          "-1",
                                "2",          "3",
                                "4",          "0.5",
                                "1e-9",       "-1e-9",
                                "1e9",        "-1e9",
                                "1e10",       "1e38",
                                "1e39",       "1e308",
                                "1e309",      "1e400",
                                "-1e400",     "1e-320",
                                "1e-400",     "nan",
                                "inf",        "-inf",
                                "+1",         "+-1",
                                "--1",        ".5",
                                "5.",         ".",
                                "1e",         "0x10",
                                "1,5",        "1e+5",
                                "16384",      "16385",
                                "65536",      "2147483647",
                                "2147483648", "4294967295",
                                "4294967296", "4294967299",
                                "1000000000", "99999999999999999999",
                                "1e-8",       "1.00000000000000001",
                                "0.1",        "180",
                                "179.999999", "90",
                                "360"};

std::string random_token(const std::vector<std::string>& keywords, Random& random) {
    if (random.one_in(2)) return random.pick(kNumbers);
    if (random.one_in(2)) return std::to_string(static_cast<int>(random.below(2001)) - 1000);
    return random.pick(keywords);
}

void damage_token(std::string& text, const std::vector<std::string>& keywords, Random& random) {
    const std::vector<Piece> pieces = tokens_of(text);
    if (pieces.empty()) {
        text += random.pick(keywords);
        return;
    }
    const Piece piece = random.pick(pieces), other = random.pick(pieces);
    const std::string token = text.substr(piece.start, piece.size);
    switch (random.below(6)) {
        case 0:
            text.erase(piece.start, piece.size);
            break;
        case 1:
            text.insert(piece.start, random_token(keywords, random) + " ");
            break;
        case 2:
            text.replace(piece.start, piece.size, text.substr(other.start, other.size));
            break;
        case 3:
            text.insert(piece.start + piece.size, random.one_in(2) ? "\n" : "#");
            break;
        default:
            text.replace(piece.start, piece.size, random_token(keywords, random));
    }
}

void damage_line(std::string& text, Random& random) {
    const std::vector<Piece> pieces = lines_of(text);
    if (pieces.empty()) return;
    const Piece piece = random.pick(pieces), other = random.pick(pieces);
    const std::string line = text.substr(piece.start, piece.size);
    switch (random.below(4)) {
        case 0:
            text.erase(piece.start, piece.size);
            break;
        case 1:
            text.resize(piece.start + random.below(piece.size + 1));
            break;
        default:
            text.insert(other.start, line);
    }
}

void damage_line_ends(std::string& text, Random& random) {
    const std::string end = random.one_in(2) ? "\r\n" : random.one_in(2) ? "\r" : " ";
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + end.size()))
        text.replace(at, 1, end);
}

}  // namespace

void damage_tokens(std::string& text, const std::vector<std::string>& keywords, Random& random) {
    if (random.one_in(50)) return damage_line_ends(text, random);
    if (random.one_in(50)) {
        text.insert(0, "\xEF\xBB\xBF");  // a byte order mark
        return;
    }
    if (random.one_in(4)) return damage_line(text, random);
    damage_token(text, keywords, random);
}

}  // namespace raya::fuzz
