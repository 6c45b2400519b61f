// Code shared by the custom libFuzzer mutators: random choices, and mutations of any text.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace raya::fuzz {

class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed + 1) {}
    std::size_t below(std::size_t limit) { return static_cast<std::size_t>(engine_() >> 4) % limit; }
    bool one_in(std::size_t n) { return below(n) == 0; }
    template <class List>
    const auto& pick(const List& list) {
        return list[below(std::size(list))];
    }

  private:
    std::minstd_rand engine_;
};

/// Applies libFuzzer's own mutations: bit flips, copies, dictionary entries, operands of the program's comparisons.
inline void mutate_bytes(std::string& text, std::size_t most = 4096) {
    const std::size_t size = text.size();
    text.resize(std::max(most, size + 64));
    text.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(text.data()), size, text.size()));
}

/// Copies the text to libFuzzer's buffer of `most` bytes, cut to that size; returns the number of bytes copied.
inline std::size_t store(const std::string& text, std::uint8_t* data, std::size_t most) {
    const std::size_t size = std::min(text.size(), most);
    if (size > 0) std::memcpy(data, text.data(), size);
    return size;
}

/// Mutates tokens and lines of a text: removes, repeats, swaps and replaces them. `words`: the format's keywords.
void damage_words(std::string& text, const std::vector<std::string>& words, Random& random);

/// Mutates values of a JSON text: removes, repeats or renames them, or changes their value or type. Returns false if
/// the text is not JSON.
bool damage_json(std::string& text, Random& random);

}  // namespace raya::fuzz
