// text_table(): the layout of tables in text output.
#include <catch2/catch.hpp>

#include "host/report/table.hpp"

using namespace raya;

TEST_CASE("text_table: aligns text to the left and numbers to the right", "[report]") {
    CHECK(text_table({{"label", "launches", "ns"}, {"trace", "12", "345678"}, {"bus.gather", "1", "90"}}) ==
          "label       launches      ns\n"
          "trace             12  345678\n"
          "bus.gather         1      90\n");
}

TEST_CASE("text_table: aligns a column to the left if one cell is not a number", "[report]") {
    CHECK(text_table({{"name", "time"}, {"a", "1.5 ms"}, {"b", "none"}}) ==
          "name  time\n"
          "a     1.5 ms\n"
          "b     none\n");
}

TEST_CASE("text_table: a dash counts as a number", "[report]") {
    CHECK(text_table({{"name", "time"}, {"a", "1.5"}, {"b", "-"}}) ==
          "name  time\n"
          "a      1.5\n"
          "b        -\n");
}

TEST_CASE("text_table: accepts short rows, wide headers, and a header without rows", "[report]") {
    CHECK(text_table({{"a", "b"}, {"long word"}, {"x", "7"}}) ==
          "a          b\n"
          "long word\n"
          "x          7\n");
    CHECK(text_table({{"header"}, {"1"}}) == "header\n     1\n");
    CHECK(text_table({{"a", "b"}}) == "a  b\n");
}
