// A plot within a document: the drawing itself, in colours that follow the reader's, and the figures that it shows.
#pragma once
#include <string>

#include "host/study/page.hpp"

namespace raya {

/// The text of an SVG file as a part of a document: what stands before <svg is left out, and every colour #rrggbb of a
/// style becomes var(--plot-rrggbb, #rrggbb), by which style.css turns it for dark surroundings. Empty where `file`
/// holds no drawing.
std::string inlined_svg(const std::string& file);

/// `file`: the text of the plot's SVG file (tools/plot.py); `missing`: why there is none, where it is empty; `json`:
/// the name of the file that has every point.
std::string html_figure(const StudyPlot& plot, const std::string& file, const std::string& missing,
                        const std::string& json);

}  // namespace raya
