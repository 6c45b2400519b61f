// For each mutated NFF file, the reader must return a scene or throw an error with file and line. The scene must be
// equal after writing and reading.
#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <exception>
#include <string>

#include "host/error.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/split_mix.hpp"

using namespace raya;

namespace {

const std::array<std::string, 4> kTexts{
    "b 0.078 0.361 0.753\nv\nfrom 2.1 1.3 1.7\nat 0 0 0\nup 0 0 1\nangle 45\nhither 0.01\nresolution 512 512\nl 4 3 2\n"
    "f 1 0.75 0.33 0.8 0 100000 0 1\np 4\n12 12 -0.5\n-12 12 -0.5\n-12 -12 -0.5\n12 -12 -0.5\ns 0 0 0 0.5\n",
    "# planes\nv\nfrom 0 -8 3\nat 0 0 1\nup 0 0 1\nangle 30\nhither 0\nresolution 64 64\nl 1 2 3 0.5 0.5 0.5\n"
    "#raya checker 1 1 1 0 0 0 1\n#raya plane 0 0 1 0\nf 1 1 1 0 0.1 9 0.9 1.5\n#raya plane 1 2 3 4\ns 0 0 1 -1e0\n",
    "v\r\nfrom 0 0 -8\r\nat 0 0 0\r\nup 0 1 0\r\nangle 25\r\nhither 0.001\r\nresolution 256 256\r\nl -10 3 -20\r\n"
    "f 0.7 0.5 0.5 0.7 0.7 11.1 0 1\r\nc -0.7 -0.1 -0.2 0.075 0.7 0.1 0.2 0.075\r\nc 0 0 0 -1\r\n0 0 1 0\r\n",
    "v from 0 0 9 at 0 0 0 up 0 1 0 angle 25 hither 0 resolution 9 9\npp 3\n0 0 0 0 0 1\n1 0 0 0.1 0 1\n0 1 0 0 0.1 1\n"
    "p 5 0 0 0 2 0 0 2 2 0 1 0.5 0 0 2 0\n#raya checker 1 0 0 0 1 0 .25 # note\npp 4\n0 0 1 0 0 1\n1 0 1 0 0 1\n"
    "1 1 1 0 0 1\n0 1 1 0 0 1\n"};

/// Returns one of the texts after up to three changes: a piece is replaced by a token or by a piece of another text, or
/// a byte by a random one.
std::string mutated(SplitMix random) {
    static const std::array<std::string, 20> kTokens{
        "nan", "-inf", "1e999", "-1",       "0",  "1e-320", "1000000000", "#raya ", "\n",  " ",
        "p ",  "v\n",  "\ns ",  "checker ", "c ", "pp 3\n", "#",          "-",      "1e9", std::string(1, '\0')};
    const auto below = [&](std::size_t limit) { return static_cast<std::size_t>(random.next() % limit); };
    std::string text = kTexts[below(kTexts.size())];
    for (std::size_t rounds = 1 + below(3); rounds > 0; --rounds) {
        const std::string& donor = kTexts[below(kTexts.size())];
        const std::size_t start = below(text.size() + 1), length = below(3) * below(20);
        const std::size_t digit = text.find_first_of("0123456789", start);
        switch (below(4)) {
            case 0:
                text.replace(start, length, kTokens[below(kTokens.size())]);
                break;
            case 1:
                text.replace(start, length, donor, below(donor.size()), below(40));
                break;
            case 2:
                if (start < text.size()) text[start] = static_cast<char>(below(256));
                break;
            default:
                if (digit != std::string::npos) text[digit] = static_cast<char>('0' + below(10));
        }
    }
    return text;
}

/// Returns true if a message starts with "m.nff:LINE: " and has more text after it.
bool has_file_and_line(const std::string& message) {
    const std::string name = "m.nff:";
    if (!message.starts_with(name)) return false;
    const std::size_t end = message.find_first_not_of("0123456789", name.size());
    return end != std::string::npos && end > name.size() && message[name.size()] != '0' &&
           message.substr(end, 2) == ": " && message.size() > end + 2;
}

/// Returns a description of the reader's defect that a text reveals, or an empty string. Increments `accepted` if the
/// reader accepts the text.
std::string reader_defect(const std::string& text, int& accepted) {
    try {
        const Scene scene = parse_nff(text, "m.nff");
        ++accepted;
        return parse_nff(write_nff(scene), "m.nff") == scene ? "" : "the scene changes if it is written and read again";
    } catch (const UserError& error) {
        return has_file_and_line(error.what()) ? "" : std::string("message without file and line: ") + error.what();
    } catch (const std::exception& error) {
        return std::string("not a UserError: ") + error.what();
    }
}

}  // namespace

TEST_CASE("mutated files are either read or refused", "[nff]") {
    const char* variable = std::getenv("RAYA_MUTATIONS");
    const int count = variable ? std::atoi(variable) : 4000;  // number of mutated files
    int accepted = 0;
    for (int seed = 0; seed < count; ++seed) {
        const std::string text = mutated(SplitMix(static_cast<std::uint64_t>(seed)));
        const std::string defect = reader_defect(text, accepted);
        if (defect.empty()) continue;
        CAPTURE(seed, text);
        FAIL_CHECK(defect);
    }
    INFO("the reader accepts " << accepted << " of " << count << " files");
    CHECK(accepted > count / 20);  // some mutated files stay valid
    CHECK(accepted < count / 2);   // most mutated files are invalid
}
