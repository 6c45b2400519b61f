// Code shared by the custom libFuzzer mutators: random choices, and mutations of texts.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <string_view>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace raya::fuzz {

class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed + 1) {}
    /// Returns an integer in [0, limit).
    std::size_t below(std::size_t limit) { return static_cast<std::size_t>(engine_() >> 4) % limit; }
    /// Returns true with probability 1 / n.
    bool one_in(std::size_t n) { return below(n) == 0; }
    template <class List>
    const auto& pick(const List& list) {
        return list[below(std::size(list))];
    }

  private:
    std::minstd_rand engine_;
};

/// Applies libFuzzer's own mutations: bit flips, copies, dictionary entries, operands of the program's comparisons.
inline void mutate_bytes(std::string& text, std::size_t max_size = 4096) {
    const std::size_t size = text.size();
    text.resize(std::max(max_size, size + 64));
    text.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(text.data()), size, text.size()));
}

/// Copies the text to libFuzzer's buffer of max_size bytes, cut to max_size. Returns the number of bytes copied.
inline std::size_t store(const std::string& text, std::uint8_t* data, std::size_t max_size) {
    const std::size_t size = std::min(text.size(), max_size);
    if (size > 0) std::memcpy(data, text.data(), size);
    return size;
}

/// Mutates values of a JSON text: removes, repeats or renames them, or changes their value or type. Returns false if
/// the text is not JSON.
bool damage_json(std::string& text, Random& random);

}  // namespace raya::fuzz
