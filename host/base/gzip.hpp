// Text that is compressed as it comes, into one gzip file in memory.
#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace raya {

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
