#include "host/base/encoding.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#define XXH_INLINE_ALL  // the functions in the header, so that no library is needed
#include <xxhash.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <limits>
#include <new>
#include <numeric>
#include <stdexcept>

namespace raya {
namespace {

// For packet traces, level 4 takes half the time of zlib's default level, 6, and gives 8 % more bytes.
constexpr int kCompressionLevel = 4;
constexpr int kWindowBits = MAX_WBITS + 16;  // maximum window; + 16 for gzip's header and trailer
constexpr int kMemLevel = 8;                 // zlib's default

}  // namespace

std::string replaced(std::string text, const std::string& old_part, const std::string& new_part) {
    for (std::size_t at = text.find(old_part); at != std::string::npos; at = text.find(old_part, at + new_part.size()))
        text.replace(at, old_part.size(), new_part);
    return text;
}

std::string environment_value(const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr ? value : "";
}

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= text.size(); at += parts.back().size() + 1)
        parts.emplace_back(text.substr(at, text.find(separator, at) - at));
    return parts;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::string_view group = bytes.substr(i, 3);
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < group.size() ? static_cast<unsigned char>(group[k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= group.size() ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string hex_digits(std::span<const unsigned char> bytes) { return fmt::format("{:02x}", fmt::join(bytes, "")); }

void convert_little_endian([[maybe_unused]] std::span<std::byte> numbers, [[maybe_unused]] std::size_t number_bytes) {
    if constexpr (std::endian::native == std::endian::big)
        for (std::size_t at = 0; at < numbers.size(); at += number_bytes)
            std::ranges::reverse(numbers.subspan(at, number_bytes));
}

std::string words_hash(std::span<const std::uint32_t> words) {
    std::vector<std::uint32_t> converted;
    if constexpr (std::endian::native == std::endian::big) {
        converted.assign(words.begin(), words.end());
        convert_little_endian(std::as_writable_bytes(std::span(converted)), sizeof words[0]);
        words = converted;
    }
    return bytes_hash({reinterpret_cast<const char*>(words.data()), words.size_bytes()});
}

std::string bytes_hash(std::string_view bytes) {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
    return hex_digits(canonical.digest);
}

GzipText::GzipText()
    : stream_(new z_stream{}, [](z_stream* stream) {
          deflateEnd(stream);
          delete stream;
      }) {
    if (deflateInit2(stream_.get(), kCompressionLevel, Z_DEFLATED, kWindowBits, kMemLevel, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::bad_alloc();
}

void GzipText::append(std::string_view text) {
    constexpr std::size_t kMaxInput = std::numeric_limits<uInt>::max();  // bytes that one call of zlib accepts
    for (; text.size() > kMaxInput; text.remove_prefix(kMaxInput)) deflate_all(text.substr(0, kMaxInput), false);
    deflate_all(text, false);
}

std::string GzipText::finish() {
    deflate_all({}, true);
    return std::move(bytes_);
}

void GzipText::deflate_all(std::string_view text, bool last) {
    z_stream& z = *stream_;
    std::array<Bytef, 1 << 16> block{};
    const void* const in = text.data();
    z.next_in = const_cast<Bytef*>(static_cast<const Bytef*>(in));  // zlib does not write to it
    z.avail_in = static_cast<uInt>(text.size());
    do {
        z.next_out = block.data();
        z.avail_out = static_cast<uInt>(block.size());
        deflate(&z, last ? Z_FINISH : Z_NO_FLUSH);  // fails only for an invalid stream
        bytes_.append(block.begin(), block.end() - z.avail_out);
    } while (z.avail_out == 0);
}

namespace {

/// Returns Levenshtein's edit distance from `a` to `b`.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> distance(b.size() + 1);  // [j]: from a's first characters to b's first j characters
    std::iota(distance.begin(), distance.end(), std::size_t{0});
    for (const char c : a) {
        std::size_t diagonal = distance[0]++;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (c != b[j]);
            diagonal = distance[j + 1];
            distance[j + 1] = std::min({replaced, distance[j] + 1, distance[j + 1] + 1});
        }
    }
    return distance.back();
}

}  // namespace

std::string nearest_name(const std::string& misspelling, const std::vector<std::string>& names) {
    constexpr std::size_t kMinPrefixSize = 3;
    std::string nearest;
    std::size_t min_distance = misspelling.size() / 3 + 1;
    for (const std::string& name : names) {
        const bool has_prefix = misspelling.size() >= kMinPrefixSize && name.starts_with(misspelling);
        const std::size_t distance = has_prefix ? 0 : edit_distance(misspelling, name);
        if (distance >= min_distance) continue;
        min_distance = distance;
        nearest = name;
    }
    return nearest;
}

std::string did_you_mean(const std::string& misspelling, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(misspelling, names);
    return nearest.empty() ? "" : " (did you mean " + nearest + "?)";
}

}  // namespace raya
