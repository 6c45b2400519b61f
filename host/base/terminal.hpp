// The terminal that a person reads on.
#pragma once
#include <cstddef>

namespace raya {

/// Letters of a line for text on stdout, 40..120: what the environment variable COLUMNS says, where it is a number from
/// 1 to 10,000, else the terminal; 80 where stdout is none.
std::size_t text_width();

}  // namespace raya
