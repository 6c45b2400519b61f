#include "host/study/ensemble.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/scene/random_view.hpp"

namespace raya {

std::size_t view_count(const Scene& scene, std::uint32_t size, std::size_t most) {
    constexpr std::size_t kTests = std::size_t{1} << 27, kFewest = 4;  // pixels x objects of all views together
    const std::size_t tests = std::size_t{size} * size * std::max<std::size_t>(scene.object_count(), 1);
    return std::clamp(kTests / tests, std::min(kFewest, most), most);
}

Ensemble ensemble_of(Laboratory& lab, const LabelledScene& scene, std::uint32_t size, AntialiasMethod method,
                     std::size_t most) {
    Ensemble ensemble{&lab.costs(scene, size, method)};
    const std::size_t count = view_count(scene.scene, size, most);
    for (std::size_t seed = 1; seed <= count; ++seed)
        ensemble.views.push_back(
            &lab.costs({fmt::format("{}, view {}", scene.label, seed), random_view(scene.scene, seed)}, size, method));
    return ensemble;
}

std::string with_interval(const Estimate& estimate, int digits) {
    if (!estimate.has_interval()) return fmt::format("{:.{}f}", estimate.mean, digits);
    return fmt::format("{:.{}f} +- {:.{}f}", estimate.mean, digits, estimate.half_width, digits);
}

ClaimVerdict verdict_of(bool seen, bool contrary) {
    if (seen == contrary) return ClaimVerdict::kCannotTell;
    return seen ? ClaimVerdict::kReproduced : ClaimVerdict::kNotReproduced;
}

ClaimVerdict verdict_among(double paper, std::span<const double> pictures) {
    const bool among = prediction_of({pictures.begin(), pictures.end()}).holds(paper);
    return verdict_of(among, !among && pictures.size() >= kPredictable);
}

std::string prediction_text(std::span<const double> values, int digits) {
    const Interval range = prediction_of({values.begin(), values.end()});
    return fmt::format("{:.{}f} .. {:.{}f}", range.least, digits, range.most, digits);
}

std::string range_text(std::span<const double> values, int digits) {
    return fmt::format("{:.{}f} .. {:.{}f}", std::ranges::min(values), digits, std::ranges::max(values), digits);
}

}  // namespace raya
