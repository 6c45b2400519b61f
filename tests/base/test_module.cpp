// Loadable modules: existing and missing modules, and missing functions.
#include <catch2/catch.hpp>

#include "host/base/module.hpp"
#include "host/image/encoder.hpp"

namespace raya {
namespace {
using Catch::Matchers::Contains;

TEST_CASE("a module's function is found, and errors name the missing file or function", "[module]") {
    CHECK(module_function(kEncoderModule, kEncoderFunction) == module_function(kEncoderModule, kEncoderFunction));
    CHECK_THROWS_WITH(module_function("raya_none", kEncoderFunction),
                      Contains("there is no file '") && Contains("/raya_none.so"));
    CHECK_THROWS_WITH(module_function(kEncoderModule, "raya_no_function"), Contains("raya_no_function"));
    CHECK_THROWS_AS(module_function("raya_none", kEncoderFunction), ModuleError);
}

}  // namespace
}  // namespace raya
