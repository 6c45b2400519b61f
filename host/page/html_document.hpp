// A page as one file: what its own files share, and the promise that it asks for nothing from anywhere.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace raya {

/// Bytes that a page of one picture or one report has at most, so that it goes into a letter; the studies' document is
/// as large as its drawings.
inline constexpr std::size_t kLargestPage = 1'000'000;

struct HtmlDocument {
    std::string title;                      // plain
    std::string html;                       // of the body
    std::vector<std::string> styles = {};   // embedded files, after the style of all pages (host/page/assets/style.css)
    std::vector<std::string> scripts = {};  // embedded files, run in this order when the body is there
};

/// The whole page: it can be read offline, sent and printed. Its policy has a browser refuse whatever it would have to
/// fetch. std::out_of_range for a file that is not embedded.
std::string html_document(const HtmlDocument& document);

}  // namespace raya
