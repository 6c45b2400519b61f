// Reading a text in pieces on several threads gives the scene, the remarks and the error of reading it as a whole.
#include <array>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/scene/random_below.hpp"
#include "tests/thorough.hpp"

using namespace raya;

namespace {

const NffPieces kWhole{std::size_t{1} << 40, 1};

/// What reading a text gives.
struct Reading {
    Scene scene;
    std::string error;
    std::vector<std::string> remarks;
    bool operator==(const Reading&) const = default;
};

Reading reading_of(const std::string& text, bool lenient, const NffPieces& pieces) {
    Reading reading;
    std::vector<SceneRemark> remarks;
    try {
        reading.scene = parse_nff(text, "m.nff", lenient ? &remarks : nullptr, pieces);
    } catch (const UserError& error) {
        reading.error = error.what();
    }
    for (const SceneRemark& remark : remarks) reading.remarks.push_back(remark_text("m.nff", remark));
    return reading;
}

/// Returns random entities. `odd`: also some that a strict reader refuses, or that are wrong in some places.
std::string random_entities(SplitMix& random, std::size_t count, bool odd) {
    static const std::vector<std::string> kEntities{"s 0 0 1 2\n",
                                                    "s 1 2 3\n4\n",
                                                    "s 1 2\r\n3 0.5\r\n",
                                                    "p 3\n0 0 0\n1 0 0\n0 1 0\n",
                                                    "p 4 0 0 0 1 0 0 1 1 0 0 1 0\n",
                                                    "pp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 1 1\n",
                                                    "c 0 0 0 1\n0 0 1 0.5\n",
                                                    "f 1 0.5 0.25 1 0 0 0 1\n",
                                                    "f 0.5 0.5 0.25 1 0 0 0 1\n",
                                                    "#raya checker 1 1 1 0 0 0 1\np 3 0 0 0 1 0 0 0 1 0\n",
                                                    "#raya checker 1 1 1 0 0 0 2\n# spheres follow\n"
                                                    "s 0 0 0 1\nf 1 1 1 1 0 0 0 1\n#raya plane 0 0 1 0\n",
                                                    "#raya plane 0 0 1 0\n",
                                                    "l 1 2 3\n",
                                                    "l 1 2 3 1 0.5 0.5\n",
                                                    "# s 1 2 3 4\n\n"};
    static const std::vector<std::string> kOdd{"s 1 2 3 0\n",
                                               "p 3\n0 0 0\n0 0 0\n0 1 0\n",
                                               "p 4 0 0 0 1 0 0 1 1 0.5 0 1 0\n",
                                               "pp 3\n0 0 0 0 0 1\n1 0 0 0 0 0\n0 1 0 0 1 1\n",
                                               "la 0.2 0.2 0.2\n",
                                               "tt wood.ppm 0 0 1\n0 1 2\n",
                                               "c 0 0 0 0\n0 0 1 0\n"};
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& list = odd && random_below(random, 4) == 0 ? kOdd : kEntities;
        text += list[random_below(random, list.size())];
    }
    return text;
}

const std::string kPiecesView = "v\nfrom 0 -5 1\nat 0 0 1\nup 0 0 1\nangle 40\nhither 0.5\nresolution 320 200\n";

/// Inserts a fault, a second view or background, or an unfinished entity at a random place.
void add_fault(std::string& text, SplitMix& random) {
    static const std::vector<std::string> kFaults{"\ns 1 2\n",
                                                  "\ns 1 2 3 4 5\n",
                                                  "x",
                                                  "\n#raya checker 1 1 1 0 0 0 1\n",
                                                  "\x01",
                                                  "\nb 1 1 1\n",
                                                  "\n" + kPiecesView,
                                                  "\np 1000000\n",
                                                  " s 0 0 0 1",
                                                  "-",
                                                  "\nsphere of glass\n",
                                                  "nan",
                                                  "\n#raya plain 1\n",
                                                  "1e999"};
    text.insert(random_below(random, text.size()), kFaults[random_below(random, kFaults.size())]);
}

}  // namespace

TEST_CASE("NFF in pieces: the same scene, remarks and errors as in one piece", "[nff]") {
    std::array<unsigned, 2> errors{};  // strict; lenient
    const unsigned cases = quick_cases(400, 20000);
    for (unsigned seed = 1; seed <= cases; ++seed) {
        SplitMix random(seed);
        std::string text = seed % 7 == 0 ? "From: somebody@example.org\n\n" : seed % 5 == 0 ? "\xEF\xBB\xBF" : "";
        const std::string objects = random_entities(random, random_below(random, 60), seed % 2 == 0);
        text += seed % 3 == 0 ? objects + kPiecesView : kPiecesView + objects;
        text += random_entities(random, random_below(random, 20), false) + "s 0 0 0 1\n";
        if (random_below(random, 2) == 0) add_fault(text, random);
        for (const bool lenient : {false, true}) {
            const Reading expected = reading_of(text, lenient, kWhole);
            errors[lenient] += !expected.error.empty();
            for (const unsigned threads : {1u, 2u, 3u, 8u}) {
                const NffPieces pieces{1 + random_below(random, threads == 1 ? 5 : 300), threads};
                CAPTURE(seed, lenient, threads, pieces.bytes, text);
                CHECK(reading_of(text, lenient, pieces) == expected);
            }
        }
    }
    for (const unsigned number : errors) {  // both readers accept some texts and refuse others
        CHECK(number > cases / 8);
        CHECK(number < cases * 7 / 8);
    }
}

TEST_CASE("NFF in pieces: lines of errors and remarks count from the start of the file", "[nff]") {
    std::string text = kPiecesView;
    for (int i = 0; i < 1000; ++i) text += "s 0 0 0 1\n";  // lines 8..1007
    const NffPieces pieces{100, 3};
    CHECK(reading_of(text + "s 0 0 0 0\n" + text.substr(kPiecesView.size()) + "s 0 0 0 0\n", true, pieces).remarks ==
          std::vector<std::string>{"m.nff:1008: sphere of radius 0, left out (2 in all)"});
    CHECK(reading_of(text + "s 0 0 0 0\n", false, pieces).error == "m.nff:1008: the radius of the sphere is zero");
    CHECK(reading_of(text + "#raya checker 1 1 1 0 0 0 1\n", true, pieces).error ==
          "m.nff:1008: no plane or polygon follows this '#raya checker'");
}

TEST_CASE("NFF in pieces: a generated scene of every kind of object", "[nff]") {
    for (const Scene& scene : {generate_lattice(6), generate_gears(2), generate_random(3000, 1)}) {
        const std::string text = write_nff(scene);
        for (const std::size_t bytes : {777, 10000}) CHECK(parse_nff(text, scene.name, nullptr, {bytes, 2}) == scene);
    }
}
