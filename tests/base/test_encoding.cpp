// Encodings of text and bytes, and suggestions for misspelt names.
#include <catch2/catch.hpp>
#include <string>

#include "host/base/encoding.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/base/gunzip.hpp"

namespace raya {
namespace {

TEST_CASE("base64() encodes the examples of RFC 4648", "[encoding]") {
    CHECK(base64("") == "");
    CHECK(base64("f") == "Zg==");
    CHECK(base64("fo") == "Zm8=");
    CHECK(base64("foobar") == "Zm9vYmFy");
    CHECK(base64("\xff\xfe\xfd\xfb\x7f") == "//79+38=");
}

TEST_CASE("gzip unpacks the appended text, however it was divided into pieces", "[encoding]") {
    constexpr std::uint64_t kSeed = 41;
    SplitMix random(kSeed);
    for (int i = 0; i < 20; ++i) {
        CAPTURE(kSeed, i);
        const std::uint64_t pieces = random.next() % 20, max_length = std::uint64_t{1} << (random.next() % 19);
        const bool noise = random.next() % 2 == 0;  // false: text that compresses well
        std::string text;
        GzipText file;
        for (std::uint64_t piece = 0; piece < pieces; ++piece) {
            std::string part(random.next() % max_length, 'a');
            if (noise)
                for (char& c : part) c = static_cast<char>(random.next());
            file.append(part);
            text += part;
        }
        const std::string bytes = file.finish();
        const bool same = gunzip(bytes) == text;  // a bool, so that a failure does not print megabytes
        CHECK(same);
        CHECK(bytes.substr(0, 8) == std::string("\x1f\x8b\x08\0\0\0\0\0", 8));  // gzip, deflate, no name, no date
        if (!noise && text.size() > 100'000) CHECK(bytes.size() < text.size() / 100);
    }
}

TEST_CASE("nearest_name: returns the name with the minimum edit distance, or one that begins with the misspelling",
          "[encoding]") {
    const std::vector<std::string> names = {"render", "devices", "generate", "bench", "study", "verify"};
    for (const auto& [misspelling, name] : {std::pair{"rendr", "render"},
                                            {"redner", "render"},
                                            {"gen", "generate"},
                                            {"device", "devices"},
                                            {"study", "study"},
                                            {"x", ""},
                                            {"", ""},
                                            {"paint", ""},
                                            {"frobnicate", ""}})
        CHECK(nearest_name(misspelling, names) == name);
    CHECK(did_you_mean("verfiy", names) == " (did you mean verify?)");
    CHECK(did_you_mean("paint", names).empty());
}

}  // namespace
}  // namespace raya
