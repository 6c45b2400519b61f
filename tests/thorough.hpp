// How much a test looks at: what one waits for, or everything.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace raya {

/// Whether RAYA_THOROUGH=1 is set, as ctest's entries labelled `sweep` do: all formats, lanes, scenes and random cases.
/// Else few of each, so chosen that every kind of fault is still seen.
inline bool thorough() {
    const char* text = std::getenv("RAYA_THOROUGH");
    return text != nullptr && std::string_view(text) == "1";
}

/// Lanes of a case that does not care: 0, the device's own, where everything is looked at or RAYA_OWN_LANES is set;
/// else four, whose kernels are compiled in a third of the time of sixteen.
inline std::uint32_t usual_lanes() { return thorough() || std::getenv("RAYA_OWN_LANES") != nullptr ? 0 : 4; }

/// The first `few` of `all`, or all of them: for `for (... : quick(2, {...}))`.
template <class T>
std::vector<T> quick(std::size_t few, std::initializer_list<T> all) {
    return {all.begin(), thorough() ? all.end() : all.begin() + few};
}

/// The same of a container, which may have fewer.
template <class Container>
auto quick_of(std::size_t few, const Container& all) {
    using std::begin;
    using std::size;
    return std::vector(begin(all), begin(all) + (thorough() ? size(all) : std::min(few, size(all))));
}

/// For crossings of many things with many values: everything, or the next one value in turn.
template <class Container>
Container by_turns(const Container& all) {
    static std::size_t turn = 0;
    return thorough() ? all : Container{all[turn++ % all.size()]};
}

/// So many random cases.
inline unsigned quick_cases(unsigned few, unsigned all) { return thorough() ? all : few; }

}  // namespace raya
