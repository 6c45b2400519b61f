// Base64: the examples of RFC 4648.
#include <catch2/catch.hpp>

#include "host/base/encoding.hpp"

namespace raya {
namespace {

TEST_CASE("base64() encodes the examples of RFC 4648", "[base64]") {
    CHECK(base64("") == "");
    CHECK(base64("f") == "Zg==");
    CHECK(base64("fo") == "Zm8=");
    CHECK(base64("foo") == "Zm9v");
    CHECK(base64("foobar") == "Zm9vYmFy");
    CHECK(base64("\xff\xfe\xfd\xfb\x7f") == "//79+38=");
}

}  // namespace
}  // namespace raya
