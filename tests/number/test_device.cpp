// Names the device that the other tests run on, for tools/number_vectors. Hidden: it tests nothing.
#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "cl/device.hpp"

namespace raya {

TEST_CASE("names the device", "[.device]") {
    fmt::print("device: {}\n", device_info(choose_device("")).name);
    SUCCEED();
}

}  // namespace raya
