// Text of sizes, times and rates in a suitable unit. The texts of a required size and of a smaller available size
// always differ.
#include <catch2/catch.hpp>

#include "host/model/number_format.hpp"

namespace raya {
namespace {

TEST_CASE("sizes are in bytes below 1 KB, else in KB; required sizes are rounded up, available sizes down",
          "[unit_text]") {
    CHECK(required_size_text(100) == "100 bytes");
    CHECK(available_size_text(1023) == "1023 bytes");
    CHECK(required_size_text(1024) == "1.0 KB");
    CHECK(required_size_text(4403) == "4.3 KB");
    CHECK(required_size_text(4097) == "4.1 KB");
    CHECK(available_size_text(4095) == "3.9 KB");
    CHECK(available_size_text(4096) == "4 KB");
    CHECK(available_size_text(32768) == "32 KB");
    CHECK(available_size_text(4 << 20) == "4096 KB");
    for (std::uint64_t bytes = 1024; bytes < 40'000; bytes += 7)
        CHECK(std::stod(required_size_text(bytes + 1)) > std::stod(available_size_text(bytes)));
}

TEST_CASE("amounts of data have a suitable unit", "[unit_text]") {
    CHECK(data_text(9'999) == "9999 bytes");
    CHECK(data_text(12'800) == "12.5 KB");
    CHECK(data_text(1.5 * 1024 * 1024) == "1.5 MB");
    CHECK(data_text(3e9) == "2861.0 MB");
}

TEST_CASE("times and rates have a suitable unit", "[unit_text]") {
    CHECK(time_text(0.25) == "0.2 ms");
    CHECK(time_text(9'999) == "9999.0 ms");
    CHECK(time_text(10'000) == "10.0 s");
    CHECK(time_text(600'000) == "10.0 min");
    CHECK(time_text(533'457'027) == "148.2 h");
    CHECK(rate_text(24.6e6) == "24.6 Mrays/s");
    CHECK(rate_text(999'999) == "1000.0 krays/s");
    CHECK(rate_text(30'000) == "30.0 krays/s");
    CHECK(rate_text(12) == "12.0 rays/s");
}

}  // namespace
}  // namespace raya
