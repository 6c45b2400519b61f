// text_table(): the layout of tables in text output.
#include <catch2/catch.hpp>

#include "host/report/table.hpp"

using namespace raya;

TEST_CASE("text_table: aligns columns of numbers and dashes to the right, others to the left", "[report]") {
    CHECK(text_table({{"label", "launches", "ns", "name", "time"},
                      {"trace", "12", "-", "a", "1.5 ms"},
                      {"bus.gather", "1", "345678", "b", "none"},
                      {"x"}}) ==
          "label       launches      ns  name  time\n"
          "trace             12       -  a     1.5 ms\n"
          "bus.gather         1  345678  b     none\n"
          "x\n");
    CHECK(text_table({{"a", "b"}}) == "a  b\n");
}
