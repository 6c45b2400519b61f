#include "host/study/html_figure.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "host/page/html.hpp"
#include "host/study/page_text.hpp"

namespace raya {
namespace {

constexpr std::string_view kBefore = ": #";  // of a colour in a style; an id's reference has no blank before it
constexpr std::size_t kDigits = 6;

// Points of a plot that nobody could draw are not folded away: they are all that there is of it.
std::string drawing_of(const std::string& svg, const StudyPlot& plot, const std::string& missing) {
    if (svg.empty()) return fmt::format("<p class=\"missing\">Not drawn: {}.</p>\n", html_prose(missing));
    return fmt::format(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">"
        "<div class=\"drawing\">{}</div></div>\n",
        html_text(plot.title), svg);
}

}  // namespace

std::string inlined_svg(const std::string& file) {
    const std::size_t begin = file.find("<svg");
    if (begin == std::string::npos || file.find("</svg>", begin) == std::string::npos) return {};
    std::string svg;
    std::size_t from = begin;
    for (std::size_t at = file.find(kBefore, from); at != std::string::npos; at = file.find(kBefore, at + 1)) {
        const std::string colour = file.substr(at + kBefore.size(), kDigits);
        if (colour.size() < kDigits || !std::ranges::all_of(colour, [](unsigned char c) { return std::isxdigit(c); }))
            continue;
        svg += file.substr(from, at - from) + fmt::format(": var(--plot-{0}, #{0})", colour);
        from = at + kBefore.size() + kDigits;
    }
    return svg + file.substr(from);
}

std::string html_figure(const StudyPlot& plot, const std::string& file, const std::string& missing,
                        const std::string& json) {
    const std::string svg = inlined_svg(file);
    const bool bars =
        std::ranges::any_of(plot.series, [](const PlotSeries& series) { return !series.half_widths.empty(); });
    std::string text = "<figure class=\"plot\">\n" + drawing_of(svg, plot, missing) + "<figcaption>";
    text += html_prose(plot.title) + '.' + (bars ? " Bars and bands: 95 % intervals." : "");
    const TextCells points = point_cells(plot);
    text += fmt::format("</figcaption>\n<details{}><summary>Its points ({})</summary>\n", svg.empty() ? " open" : "",
                        points.size() - 1);
    text += html_cut_table({plot.title + ": points", html_cells(points)},
                           fmt::format("With all digits: <a href=\"{0}\">{0}</a>.", html_text(json)));
    return text + "</details>\n</figure>\n";
}

}  // namespace raya
