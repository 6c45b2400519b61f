// Records of kernels/shared/ among the 32-bit words that hold them.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace raya {

template <class Record>
inline constexpr std::size_t kWordsOf = sizeof(Record) / sizeof(std::uint32_t);

template <class Record>
using WordsOf = std::array<std::uint32_t, kWordsOf<Record>>;

/// The record that starts at words[at].
template <class Record>
Record record_at(std::span<const std::uint32_t> words, std::size_t at) {
    WordsOf<Record> own;
    std::copy_n(words.subspan(at, own.size()).begin(), own.size(), own.begin());
    return std::bit_cast<Record>(own);
}

template <class Record>
void put_record(std::span<std::uint32_t> words, std::size_t at, const Record& record) {
    const auto own = std::bit_cast<WordsOf<Record>>(record);
    std::copy(own.begin(), own.end(), words.subspan(at, own.size()).begin());
}

}  // namespace raya
