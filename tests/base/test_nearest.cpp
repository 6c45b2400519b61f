// Suggestions for misspelt names.
#include <catch2/catch.hpp>

#include "host/base/encoding.hpp"

namespace raya {
namespace {

TEST_CASE("nearest_name: returns the name with the minimum edit distance, or one that begins with the misspelling",
          "[parse]") {
    const std::vector<std::string> names = {"render", "devices", "generate", "bench", "study", "verify"};
    CHECK(nearest_name("rendr", names) == "render");
    CHECK(nearest_name("redner", names) == "render");  // two characters are swapped
    CHECK(nearest_name("gen", names) == "generate");
    CHECK(nearest_name("device", names) == "devices");
    CHECK(nearest_name("study", names) == "study");
    for (const char* unlike : {"", "x", "go", "paint", "frobnicate"}) CHECK(nearest_name(unlike, names).empty());
    CHECK(did_you_mean("verfiy", names) == " (did you mean verify?)");
    CHECK(did_you_mean("paint", names).empty());
}

}  // namespace
}  // namespace raya
