// Text and bytes in other forms: replaced, base64, hexadecimal digits, a hash, gzip.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace raya {

/// `text` with every `what` in it replaced by `by`.
std::string replaced(std::string text, const std::string& what, const std::string& by);

std::string base64(std::string_view bytes);

/// Two lower-case hexadecimal digits a byte.
std::string hex_digits(std::span<const unsigned char> bytes);

/// XXH3 of 128 bits, as 32 lower-case hexadecimal digits.
std::string bytes_hash(std::string_view bytes);

/// The same text gives the same bytes: the file's header has no date and no name. Takes the memory of the compressed
/// bytes, and about 300 KB.
class GzipText {
  public:
    GzipText();
    ~GzipText();
    GzipText(const GzipText&) = delete;
    GzipText& operator=(const GzipText&) = delete;

    void append(std::string_view text);

    /// The whole file. Nothing can be appended afterwards: std::logic_error.
    std::string finish();

  private:
    struct Stream;
    void deflate_all(std::string_view text, bool last);

    std::unique_ptr<Stream> stream_;
    std::string bytes_;
};

}  // namespace raya
