// Plots of a study page, drawn by the project's tools/plot.py with Python and matplotlib, where the machine has them.
#pragma once
#include <filesystem>
#include <string>

#include "host/study/page.hpp"

namespace raya {

struct PlotOutcome {
    bool drawn = false;
    std::string reason;  // why not, with the remedy; empty where drawn
};

/// Draws NAME.svg and NAME.png of each of the page's plots into `folder` from the page's JSON file there (see
/// write_page()); a page without plots counts as drawn. All are drawn or none is, and plots of an earlier run are
/// removed first: they would show other figures than the page beside them. The interpreter is the one that the
/// environment variable RAYA_PYTHON names, else python3 from PATH, else /usr/bin/python3, where Debian's matplotlib is.
/// What goes wrong is told in the outcome, not thrown: a study is worth having without its plots.
PlotOutcome draw_plots(const std::filesystem::path& folder, const StudyPage& page);

}  // namespace raya
