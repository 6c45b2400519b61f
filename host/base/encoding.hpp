// Environment variables; similar names; encodings of text and bytes: replacement, parts, numbers, base64, hexadecimal,
// XXH3, gzip.
#pragma once
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct z_stream_s;  // of zlib

namespace raya {

/// Returns `text` with every occurrence of `old_part` replaced by `new_part`.
std::string replaced(std::string text, const std::string& old_part, const std::string& new_part);

/// Returns the value of an environment variable; empty if it is not set.
std::string environment_value(const char* name);

/// Returns the parts of `text` between the separators; one part if there is no separator.
std::vector<std::string> split(std::string_view text, char separator);

/// Returns the number in `text`, independently of the locale; empty unless the whole text is a number that fits the
/// type.
template <class Number>
std::optional<Number> parsed_number(std::string_view text) {
    Number number{};
    const char* const end = text.data() + text.size();
    const auto [read_to, error] = std::from_chars(text.data(), end, number);
    return error == std::errc() && read_to == end ? std::optional(number) : std::nullopt;
}

/// Returns the base64 encoding (RFC 4648) of `bytes`, with padding.
std::string base64(std::string_view bytes);

/// Returns `bytes` as lower-case hexadecimal digits, two per byte.
std::string hex_digits(std::span<const unsigned char> bytes);

/// Converts numbers of `number_bytes` bytes each between the host's byte order and little-endian order, in place.
void convert_little_endian(std::span<std::byte> numbers, std::size_t number_bytes);

/// Returns the 128-bit XXH3 hash of `bytes` as 32 lower-case hexadecimal digits.
std::string bytes_hash(std::string_view bytes);

/// Returns bytes_hash() of the words in little-endian byte order.
std::string words_hash(std::span<const std::uint32_t> words);

/// Incremental gzip compression. The same text always gives the same bytes: the gzip header contains no date and no
/// name. Memory: the compressed bytes and about 300 KB.
class GzipText {
  public:
    GzipText();

    void append(std::string_view text);

    /// Ends the compression and returns the gzip file.
    std::string finish();

  private:
    void deflate_all(std::string_view text, bool last);

    std::unique_ptr<z_stream_s, void (*)(z_stream_s*)> stream_;
    std::string bytes_;
};

// Suggestions for misspelt names.

/// Returns the name in `names` that begins with `misspelling`, if `misspelling` has 3 or more characters. Otherwise
/// returns the name with the smallest edit distance (insertions, deletions, substitutions), or "" if this distance
/// exceeds a third of the length of `misspelling`.
std::string nearest_name(const std::string& misspelling, const std::vector<std::string>& names);

/// Returns " (did you mean NAME?)" with the name that nearest_name() returns; "" if no name is similar.
std::string did_you_mean(const std::string& misspelling, const std::vector<std::string>& names);

}  // namespace raya
