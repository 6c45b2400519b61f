// One study as a section of the document.
#pragma once
#include <string>
#include <vector>

#include "host/study/page.hpp"
#include "host/study/plotter.hpp"

namespace raya {

/// What of a page lies beside it in files: what became of its plots, and of each plot the text of its SVG file.
struct PageFiles {
    PlotOutcome plots;
    std::vector<std::string> svgs = {};  // in the order of the page's plots; none where they are not drawn
};

/// The verdict as a word that is also seen by its colour.
std::string html_verdict(ClaimVerdict verdict);

/// Question, method, findings, claims, figures and tables of a page, its news, and how to repeat it.
std::string page_html(const StudyPage& page, const PageFiles& files);

}  // namespace raya
