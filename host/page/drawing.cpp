#include "host/page/drawing.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/page/html.hpp"

namespace raya {
namespace {

// Units of the drawing; letters are 12.5 high (host/page/assets/style.css).
constexpr double kWidth = 480, kHeight = 250, kLeft = 52, kRight = 456, kTop = 26, kBottom = 212;

std::string path(const char* kind, const std::string& way) {
    return fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind, way);
}

std::string line(const char* kind, double x0, double y0, double x1, double y1) {
    return path(kind, fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", x0, y0, x1, y1));
}

std::string box(const char* kind, double x0, double y0, double x1, double y1) {
    return path(kind, fmt::format("M{:.2f} {:.2f}H{:.2f}V{:.2f}H{:.2f}Z", x0, y0, x1, y1, x0));
}

// `anchor`: start, middle or end.
std::string label(const char* anchor, double x, double y, const std::string& text) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, html_text(text));
}

std::string figure(const DrawingWords& w, double height, const std::string& svg) {
    return fmt::format(
               "<figure class=\"charted\">\n<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" "
               "aria-describedby=\"{}-words\">\n<desc id=\"{}-words\">Across: {}. Up: {}. Series: {}.</desc>\n",
               kWidth, height, html_text(w.title), html_text(w.id), html_text(w.id), html_text(w.across),
               html_text(w.up), html_text(w.series)) +
           box("ground", 0, 0, kWidth, height) + svg +
           fmt::format("</svg>\n<figcaption>{}{}</figcaption>\n</figure>\n", html_prose(w.title), w.html_note);
}

// 1, 2 or 5 times a power of ten, at most `count` of which reach to `most` (> 0).
double step_to(double most, double count) {
    const double ten = std::pow(10.0, std::floor(std::log10(most / count)));
    for (const double times : {1.0, 2.0, 5.0})
        if (times * ten * count >= most) return times * ten;
    return 10 * ten;
}

struct Unit {
    double size;
    const char* name;
};
Unit unit_for(double most) {
    if (most >= 1e9) return {1e9, "thousand million "};
    if (most >= 1e6) return {1e6, "million "};
    if (most >= 1e4) return {1e3, "thousand "};
    return {1, ""};
}

// Lines and numbers from 0 up to `top`, and what they count.
std::string grid_up(const std::string& up, double top, double step) {
    const Unit unit = unit_for(top);
    std::string svg = label("start", 4, 14, unit.name + up);
    for (double value = 0; value <= top * 1.0001; value += step) {
        const double y = kBottom - (kBottom - kTop) * value / top;
        svg += line("grid", kLeft, y, kRight, y) +
               label("end", kLeft - 6, y + 4, fmt::format("{:.6g}", value / unit.size));
    }
    return svg;
}

// Numbers of bars, and what they are.
std::string numbers_across(const std::string& across, std::size_t count) {
    std::string svg = label("end", kRight, kHeight - 4, across);
    const double all = static_cast<double>(count), step = std::max(1.0, step_to(all, 8));
    for (double number = 0; number < all; number += step)
        svg +=
            label("middle", kLeft + (kRight - kLeft) * (number + 0.5) / all, kBottom + 16, fmt::format("{}", number));
    return svg;
}

}  // namespace

std::string html_bars(const DrawingWords& words, const std::vector<double>& values, double mean) {
    if (values.empty()) return {};
    constexpr std::size_t kColumns = 208;  // two units wide
    const double most = std::max(*std::max_element(values.begin(), values.end()), 1e-9), step = step_to(most, 5);
    const double top = step * std::ceil(most / step * 0.9999);
    const auto height = [&](double value) { return kBottom - (kBottom - kTop) * value / top; };
    const std::size_t count = values.size(), columns = std::min(count, count <= 2 * kColumns ? count : kColumns);
    std::string svg = grid_up(words.up, top, step) + numbers_across(words.across, count);
    for (std::size_t column = 0; column < columns; ++column) {
        const auto begin = values.begin() + static_cast<std::ptrdiff_t>(column * count / columns),
                   end = values.begin() + static_cast<std::ptrdiff_t>((column + 1) * count / columns);
        const auto [low, high] = std::minmax_element(begin, end);
        const double wide = (kRight - kLeft) / static_cast<double>(columns), gap = columns > 100 ? 0.1 : 0.2;
        const double x = kLeft + wide * (static_cast<double>(column) + gap / 2);
        if (*high > *low) svg += box("bar pale", x, height(*high), x + wide * (1 - gap), height(*low));
        svg += box("bar", x, height(*low), x + wide * (1 - gap), kBottom);
    }
    svg += line("mark", kLeft, height(mean), kRight, height(mean));
    return figure(words, kHeight, svg);
}

std::string html_named_bars(const DrawingWords& words, const std::vector<NamedBar>& bars) {
    if (bars.empty()) return {};
    constexpr double kRow = 36, kBegin = 6, kEnd = 364;
    double most = 1e-300;
    for (const NamedBar& bar : bars) most = std::max({most, bar.value, bar.mark.value_or(0)});
    std::string svg;
    const auto at = [&](double value) { return kBegin + (kEnd - kBegin) * value / most; };
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const double y = kRow * static_cast<double>(i) + 14, end = std::max(at(bars[i].value), kBegin + 1);
        svg += label("start", kBegin, y, bars[i].name) + box("bar", kBegin, y + 4, end, y + 16);
        if (bars[i].mark) svg += line("mark", at(*bars[i].mark), y + 1, at(*bars[i].mark), y + 19);
        svg += label("start", std::max(end, bars[i].mark ? at(*bars[i].mark) : 0) + 6, y + 14, bars[i].told);
    }
    return figure(words, kRow * static_cast<double>(bars.size()) + 6, svg);
}

namespace {

// From a power of ten at or below `least` to one at or above `most`.
struct Decades {
    double begin, end;  // as logarithms
    Decades(double least, double most)
        : begin(std::floor(std::log10(least))), end(std::max(begin + 1, std::ceil(std::log10(most)))) {}
    double of(double value) const { return (std::log10(value) - begin) / (end - begin); }
};

std::string decade_text(double power) { return fmt::format("{:.6g}", std::pow(10.0, power)); }

std::string numbered(const std::vector<RoofPoint>& points, const Decades& across, const Decades& up) {
    struct Place {
        double x, y;
        std::size_t number;
    };
    std::vector<Place> places;
    for (std::size_t i = 0; i < points.size(); ++i)
        places.push_back({kLeft + (kRight - kLeft) * across.of(points[i].across),
                          kBottom - (kBottom - kTop) * up.of(points[i].up), i + 1});
    std::ranges::sort(places, [](const Place& a, const Place& b) { return a.y < b.y; });
    std::string svg;
    std::vector<Place> labels;
    for (const Place& p : places) {
        Place l = {p.x + 8, p.y + 4, p.number};
        const bool right = l.x + 14 > kRight;
        if (right) l.x = p.x - 8;
        for (const Place& other : labels)  // those above; a number below the last one that is near
            if (std::abs(other.x - l.x) < 18 && l.y < other.y + 12) l.y = other.y + 12;
        labels.push_back(l);
        svg += fmt::format("<path class=\"dot\" d=\"M{:.1f} {:.1f}m-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0\"/>\n", p.x, p.y) +
               label(right ? "end" : "start", l.x, l.y, fmt::format("{}", p.number));
    }
    return svg;
}

}  // namespace

std::string html_roof(const RoofWords& words, double slope, double top, const std::vector<double>& lower_tops,
                      const std::vector<RoofPoint>& points) {
    double least_across = top / slope, most_across = least_across, least_up = top, most_up = top;
    for (const double lower : lower_tops) least_up = std::min(least_up, lower);
    for (const RoofPoint& p : points) {
        least_across = std::min(least_across, p.across), most_across = std::max(most_across, p.across);
        least_up = std::min(least_up, p.up), most_up = std::max(most_up, p.up);
    }
    const Decades across(least_across / 2, most_across * 2), up(least_up / 1.5, most_up * 1.2);
    const auto x = [&](double value) { return kLeft + (kRight - kLeft) * across.of(value); };
    const auto y = [&](double value) { return kBottom - (kBottom - kTop) * up.of(value); };
    std::string svg = label("start", 4, 14, words.up) + label("end", kRight, kHeight - 4, words.across);
    const double every = std::max(1.0, std::ceil((across.end - across.begin) / 8)),
                 every_up = std::max(1.0, std::ceil((up.end - up.begin) / 8));
    for (double power = across.begin; power <= across.end; power += every) {
        const double at = kLeft + (kRight - kLeft) * (power - across.begin) / (across.end - across.begin);
        svg += line("grid", at, kTop, at, kBottom) + label("middle", at, kBottom + 16, decade_text(power));
    }
    for (double power = up.begin; power <= up.end; power += every_up) {
        const double at = kBottom - (kBottom - kTop) * (power - up.begin) / (up.end - up.begin);
        svg += line("grid", kLeft, at, kRight, at) + label("end", kLeft - 6, at + 4, decade_text(power));
    }
    // The roof rises from where it enters the drawing.
    const double from = std::max(std::pow(10.0, across.begin), std::pow(10.0, up.begin) / slope);
    svg += path("roof", fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}H{:.1f}", x(from), y(from * slope), x(top / slope),
                                    y(top), kRight));
    svg += label("end", kRight, y(top) - 5, words.tops.at(0)) +
           label("start", x(from) + 4, std::min(y(from * slope) + 14, kBottom - 4), words.slope);
    for (std::size_t i = 0; i < lower_tops.size(); ++i)
        svg += path("roof dashed", fmt::format("M{:.1f} {:.1f}H{:.1f}", x(std::max(from, lower_tops[i] / slope)),
                                               y(lower_tops[i]), kRight)) +
               label("end", kRight, y(lower_tops[i]) - 5, words.tops.at(i + 1));
    return figure(words, kHeight, svg + numbered(points, across, up));
}

}  // namespace raya
