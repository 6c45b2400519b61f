// One scene from many places: what a single picture shows may be an accident of its view.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/study/laboratory.hpp"
#include "host/study/page.hpp"
#include "host/study/rows.hpp"
#include "host/study/statistics.hpp"

namespace raya {

inline constexpr std::size_t kMostViews = 64;

/// A scene's own picture, and random views of it (host/scene/random_view.hpp), of the seeds 1, 2, ...
struct Ensemble {
    const Costs* picture = nullptr;
    std::vector<const Costs*> views = {};  // two at least
};

/// How many views are rendered of images of `size` x `size`: 64 of scenes like the paper's at 256 x 256, fewer of large
/// images and of many objects, 4 at least.
std::size_t view_count(const Scene& scene, std::uint32_t size, std::size_t most = kMostViews);

/// Renders what the laboratory does not know. Throws as Laboratory::costs().
Ensemble ensemble_of(Laboratory& lab, const LabelledScene& scene, std::uint32_t size,
                     AntialiasMethod method = AntialiasMethod::kNone, std::size_t most = kMostViews);

/// What `figure` is in the mean of the items.
template <class Items, class Figure>
Estimate mean_of_each(const Items& items, Figure figure, double confidence = 0.95) {
    std::vector<double> values;
    for (const auto& item : items) values.push_back(static_cast<double>(std::invoke(figure, item)));
    return estimate_of(values, confidence);
}

/// "0.137 +- 0.007"
std::string with_interval(const Estimate& estimate, int digits = 3);

/// The means of `estimate` over the rows, with bars of their intervals.
template <class Rows, class X, class Y>
PlotSeries line_with_bars(std::string label, const Rows& rows, X x, Y estimate, PlotStyle style = PlotStyle::kLine) {
    PlotSeries series = line(
        std::move(label), rows, x, [&](const auto& row) { return std::invoke(estimate, row).mean; }, style);
    for (const auto& row : rows) series.half_widths.push_back(std::invoke(estimate, row).half_width);
    return series;
}

/// Reproduced where a claim was seen, not reproduced where its contrary was; it cannot be told where neither was.
ClaimVerdict verdict_of(bool seen, bool contrary);

/// Of a figure that a paper has for one picture, beside those that many pictures have: reproduced where it lies in
/// their 95 % prediction interval (prediction_of()), not reproduced outside; of fewer than kPredictable pictures it
/// cannot be told outside.
ClaimVerdict verdict_among(double paper, std::span<const double> pictures);

/// prediction_of() in words: "0.115 .. 0.182"
std::string prediction_text(std::span<const double> values, int digits = 3);

/// From the least to the largest: "0.084 .. 0.221"
std::string range_text(std::span<const double> values, int digits = 3);

}  // namespace raya
