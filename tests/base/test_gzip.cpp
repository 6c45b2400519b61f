// Text that is compressed in pieces decompresses to the same text.
#include <catch2/catch.hpp>
#include <stdexcept>
#include <string>

#include "host/base/encoding.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/base/gunzip.hpp"

namespace raya {
namespace {

std::string packed(const std::string& text) {
    GzipText file;
    file.append(text);
    return file.finish();
}

TEST_CASE("gzip unpacks the appended text, however it was divided into pieces", "[report]") {
    constexpr std::uint64_t kSeed = 41;
    SplitMix random(kSeed);
    for (int i = 0; i < 40; ++i) {
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
        CHECK(bytes.size() < text.size() + text.size() / 100 + 100);
        if (!noise && text.size() > 100'000) CHECK(bytes.size() < text.size() / 100);
    }
}

TEST_CASE("the same text gives the same bytes, without a date or a name", "[report]") {
    const std::string bytes = packed("superstep,source\n1,2\n");
    CHECK(bytes == packed("superstep,source\n1,2\n"));
    REQUIRE(bytes.size() > 10);
    CHECK(bytes.substr(0, 4) == std::string("\x1f\x8b\x08\x00", 4));  // gzip, deflate, no name
    CHECK(bytes.substr(4, 4) == std::string(4, '\0'));                // no date
    CHECK(gunzip(packed("")).empty());
}

TEST_CASE("append() after finish() is an error", "[report]") {
    GzipText file;
    file.finish();
    CHECK_THROWS_AS(file.append("more"), std::logic_error);
    CHECK_THROWS_AS(file.finish(), std::logic_error);
}

}  // namespace
}  // namespace raya
