// All pages as one HTML document, for people: self-contained, so that it can be read offline, sent and printed.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/study/page_html.hpp"

namespace raya {

/// A conclusion from the verdicts, every claim, the pages in their order, how to repeat them, and the literature that
/// they speak of. It asks for nothing from anywhere, and forbids itself to; scripts add but comfort. `files`: one for
/// each page, one page at least.
std::string document_html(std::span<const StudyPage> pages, const std::vector<PageFiles>& files);

/// Writes it to index.html in `folder`, where the pages' plots lie; `plots`: what became of them, for each page. Throws
/// UserError where it cannot be written, and leaves an older one as it was.
void write_document(const std::filesystem::path& folder, std::span<const StudyPage> pages,
                    const std::vector<PlotOutcome>& plots);

}  // namespace raya
