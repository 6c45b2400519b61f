// The number of cases that a test runs: few by default, all with RAYA_THOROUGH=1.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace raya {

/// Returns true if RAYA_THOROUGH=1 is set, as in ctest's entries labelled `sweep`. Tests then run all formats, lanes,
/// scenes and random cases. Otherwise they run a few of each, chosen so that they still detect every kind of fault.
inline bool thorough() {
    const char* text = std::getenv("RAYA_THOROUGH");
    return text != nullptr && std::string_view(text) == "1";
}

/// Returns the number of lanes for tests that hold for any number of lanes: 0 (the device's default) if thorough() or
/// if RAYA_OWN_LANES is set; otherwise 4, because kernels for 4 lanes compile in a third of the time of 16 lanes.
inline std::uint32_t default_test_lanes() { return thorough() || std::getenv("RAYA_OWN_LANES") != nullptr ? 0 : 4; }

/// The number of bounces of tests that hold for any number, so that they use the same kernels. Reference images of
/// raya verify have this number, too.
inline constexpr std::uint32_t kTestBounces = 4;

/// Returns the first `few` of `all`, or all of them if thorough(): `for (... : quick(2, {...}))`.
template <class T>
std::vector<T> quick(std::size_t few, std::initializer_list<T> all) {
    return {all.begin(), thorough() ? all.end() : all.begin() + few};
}

/// Returns the first `few` elements of a container, which may have fewer, or all of them if thorough().
template <class Container>
auto quick_of(std::size_t few, const Container& all) {
    using std::begin;
    using std::size;
    return std::vector(begin(all), begin(all) + (thorough() ? size(all) : std::min(few, size(all))));
}

/// For tests of many combinations: returns all values if thorough(), otherwise a single value, a different one at each
/// call.
template <class Container>
Container quick_rotating(const Container& all) {
    static std::size_t turn = 0;
    return thorough() ? all : Container{all[turn++ % all.size()]};
}

/// Returns the number of random cases: `all` if thorough(), otherwise `few`.
inline unsigned quick_cases(unsigned few, unsigned all) { return thorough() ? all : few; }

}  // namespace raya
