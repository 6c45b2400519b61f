// Drawings of few figures as SVG within the page, in the page's own colours, readable at any width. Each says in words
// what it shows, for those who do not see it.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace raya {

/// Plain text.
struct DrawingWords {
    std::string id;  // of the page, once
    std::string title, across, up, series;
    std::string html_note = {};  // behind the title below the drawing; HTML
};

/// Bars side by side from 0 on, by their number, and a line at their mean. Many share columns: dark up to the least of
/// a column, pale up to the most. Values >= 0; nothing for none.
std::string html_bars(const DrawingWords& words, const std::vector<double>& values, double mean);

struct NamedBar {
    std::string name, told;           // beside its begin; behind its end
    double value = 0;                 // >= 0
    std::optional<double> mark = {};  // a line across it, of what it is held against
};

/// Bars below each other, each with its name above it; nothing for none.
std::string html_named_bars(const DrawingWords& words, const std::vector<NamedBar>& bars);

struct RoofPoint {
    double across = 0, up = 0;  // > 0
};

struct RoofWords : DrawingWords {
    std::string slope;              // beside the roof's rise
    std::vector<std::string> tops;  // above its top and the lower ones
};

/// Of both axes the logarithm: points, numbered from 1, below the roof min(across * slope, top); a second, lower top is
/// drawn dashed. `slope`, `top`: > 0.
std::string html_roof(const RoofWords& words, double slope, double top, const std::vector<double>& lower_tops,
                      const std::vector<RoofPoint>& points);

}  // namespace raya
