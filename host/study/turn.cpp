// A turn round the scene: whether balance, and the offset that was chosen for one picture, hold from frame to frame.
#include "host/scene/turn.hpp"

#include <functional>
#include <numeric>

#include "host/ring/schedule.hpp"
#include "host/scene/random_view.hpp"
#include "host/study/arrays.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr const char* kName = "turn";
constexpr std::uint32_t kFrames = 24;
constexpr std::size_t kMostStarts = 8;

double degrees_of(std::uint32_t frame) { return 360.0 * (frame - 1) / kFrames; }

// u of each offset in one frame.
struct FrameBalance {
    std::uint32_t frame;  // 1..kFrames
    std::vector<double> u;

    double degrees() const { return degrees_of(frame); }
    double at_zero() const { return u[0]; }
    std::uint32_t best() const { return static_cast<std::uint32_t>(std::ranges::min_element(u) - u.begin()); }
    double least() const { return u[best()]; }
};

// All frames of one turn.
struct Turn {
    std::string start;  // "as the scene has it", "view 3"
    std::uint32_t root;
    std::vector<FrameBalance> frames;

    // In the mean of the odd frames (1), or of the even ones (0), by which nothing is chosen.
    template <class Figure>
    double mean(std::uint32_t parity, Figure figure) const {
        double sum = 0;
        std::size_t n = 0;
        for (const FrameBalance& f : frames)
            if (f.frame % 2 == parity) {
                sum += std::invoke(figure, f);
                ++n;
            }
        return sum / static_cast<double>(n);
    }

    // The offset that is best in the first frame, and that which is best in the mean of the odd ones.
    std::uint32_t of_first() const { return frames.front().best(); }
    std::uint32_t of_half() const {
        std::vector<double> means;
        for (std::uint32_t p = 0; p < frames.front().u.size(); ++p)
            means.push_back(mean(1, [p](const FrameBalance& f) { return f.u[p]; }));
        return static_cast<std::uint32_t>(std::ranges::min_element(means) - means.begin());
    }

    double judged(std::uint32_t p) const {
        return mean(0, [p](const FrameBalance& f) { return f.u[p]; });
    }
    double judged_root() const { return judged(root); }
    double judged_first() const { return judged(of_first()); }
    double judged_half() const { return judged(of_half()); }
    double first_loses() const { return judged_first() - judged_half(); }
    double root_loses() const { return judged_root() - judged_half(); }
    double each_its_own() const { return mean(0, &FrameBalance::least); }

    std::vector<double> of(std::uint32_t p) const {
        return each(frames, [p](const FrameBalance& f) { return f.u[p]; });
    }
};

struct Turns {
    std::string scene, format;
    std::uint32_t size;
    Turn own;
    std::vector<Turn> others;
};

Turn turn_of(Laboratory& lab, const LabelledScene& scene, const std::string& start, std::uint32_t size) {
    std::vector<std::uint32_t> offsets(size);
    std::iota(offsets.begin(), offsets.end(), 0u);
    Turn turn{start, root_offset(size) % size, {}};
    for (std::uint32_t frame = 1; frame <= kFrames; ++frame) {
        LabelledScene seen = scene;
        seen.label = fmt::format("{}, {}, frame {}", scene.label, start, frame);
        seen.scene.view = turned(scene.scene.view, degrees_of(frame));
        turn.frames.push_back(
            {frame, imbalance_of_offsets(lab.costs(seen, size).trace, size, RAYA_FOLD_CYCLIC, offsets)});
    }
    return turn;
}

// Fewer of many objects.
std::size_t starts_of(const Scene& scene, std::uint32_t size) {
    constexpr std::size_t kTests = std::size_t{1} << 28;  // pixels x objects of all frames together
    const std::size_t tests = std::size_t{size} * size * kFrames * std::max<std::size_t>(scene.object_count(), 1);
    return std::clamp<std::size_t>(kTests / tests, 2, kMostStarts);
}

Turns turns_of(Laboratory& lab, const LabelledScene& scene) {
    const std::uint32_t size = lab.size(256);
    Turns turns{
        scene.label, format_name(format_for(scene.scene)), size, turn_of(lab, scene, "as the scene has it", size), {}};
    for (std::size_t seed = 1; seed <= starts_of(scene.scene, size); ++seed)
        turns.others.push_back(
            turn_of(lab, {scene.label, random_view(scene.scene, seed)}, fmt::format("view {}", seed), size));
    return turns;
}

// --- what is found

double mean_of(const std::vector<double>& values) { return estimate_of(values).mean; }

std::string finding_of_turn(const Turns& t) {
    const std::vector<double> root = t.own.of(t.own.root), zero = t.own.of(0);
    return finding(kName, "turn", "scene"_a = t.scene, "root"_a = t.own.root, "frames"_a = kFrames,
                   "mean"_a = mean_of(root), "range"_a = range_text(root), "first"_a = root.front(),
                   "zero"_a = mean_of(zero), "zero_range"_a = range_text(zero));
}

std::string finding_of_choice(const Turns& t) {
    const auto mean = [&](auto figure) { return with_interval(mean_of_each(t.others, figure)); };
    return finding(kName, "choice", "scene"_a = t.scene, "starts"_a = t.others.size(), "root"_a = t.own.root,
                   "of_half"_a = mean(&Turn::judged_half), "of_first"_a = mean(&Turn::judged_first),
                   "loss"_a = mean(&Turn::first_loses), "at_root"_a = mean(&Turn::judged_root),
                   "root_loss"_a = mean(&Turn::root_loses), "own"_a = mean(&Turn::each_its_own));
}

Claim claim_of_every_frame(const Turns& t) {
    std::size_t better = 0, frames = 0;
    const auto count = [&](const Turn& turn) {
        for (const FrameBalance& f : turn.frames) {
            better += f.u[turn.root] < f.at_zero();
            ++frames;
        }
    };
    count(t.own);
    for (const Turn& turn : t.others) count(turn);
    return {paper::kSpa, "Fig. 8", "The cyclic mapping with p = n balances better than p = 0.",
            verdict_of(better == frames, better < frames),
            finding(kName, "every", "scene"_a = t.scene, "better"_a = better, "frames"_a = frames)};
}

// --- the page

std::vector<StudyTable> tables_of(std::size_t number, const Turns& t) {
    const std::string stem = number == 1 ? kName : fmt::format("{}-{}", kName, number);
    const std::uint32_t first = t.own.of_first(), half = t.own.of_half(), root = t.own.root;
    const auto at = [](std::uint32_t p) { return [p](const FrameBalance& f) { return f.u[p]; }; };
    return {table_of(stem, fmt::format("u of every frame of {}, from where the scene looks", t.scene), t.own.frames,
                     {{"frame", &FrameBalance::frame},
                      {"turned by", &FrameBalance::degrees, "degrees"},
                      {"u, p = 0", &FrameBalance::at_zero},
                      {fmt::format("u, p = {}, root of P", root), at(root)},
                      {fmt::format("u, p = {}, best of frame 1", first), at(first)},
                      {fmt::format("u, p = {}, best of odd frames", half), at(half)},
                      {"best p of the frame", &FrameBalance::best},
                      {"its u", &FrameBalance::least}}),
            table_of(stem + "-starts", fmt::format("Turns of {} from random views: mean u of the even frames", t.scene),
                     t.others,
                     {{"start", &Turn::start},
                      {"best p of frame 1", &Turn::of_first},
                      {"its u", &Turn::judged_first},
                      {"best p of odd frames", &Turn::of_half},
                      {"u of that", &Turn::judged_half},
                      {fmt::format("u, p = {}", root), &Turn::judged_root},
                      {"u, each frame's best p", &Turn::each_its_own}})};
}

StudyPlot plot_of(std::size_t number, const Turns& t) {
    const std::uint32_t first = t.own.of_first(), half = t.own.of_half();
    const auto of = [&](std::string label, std::uint32_t p) {
        return line(std::move(label), t.own.frames, &FrameBalance::degrees,
                    [p](const FrameBalance& f) { return f.u[p]; });
    };
    StudyPlot plot{fmt::format("{}-{}", kName, number), fmt::format("Balance over a turn round {}", t.scene),
                   "turned by (degrees)", "u", Axes::kLogY};
    plot.series = {
        of("p = 0, column split", 0), of(fmt::format("p = {}, root of P", t.own.root), t.own.root),
        of(fmt::format("p = {}, best of frame 1", first), first),
        of(fmt::format("p = {}, best of odd frames", half), half),
        line("each frame's best p", t.own.frames, &FrameBalance::degrees, &FrameBalance::least, PlotStyle::kPoints)};
    return plot;
}

}  // namespace

StudyPage study_turn(Laboratory& lab, const Scenes& given) {
    const auto all = each(given.empty() ? Scenes{embedded_scene("centre"), embedded_scene("spheres")} : given,
                          [&](const LabelledScene& scene) { return turns_of(lab, scene); });
    Json settings;
    for (const Turns& t : all)
        settings["scenes"].push_back({{"scene", t.scene},
                                      {"size", t.size},
                                      {"pes", t.size},
                                      {"format", t.format},
                                      {"fold", "cyclic"},
                                      {"start_seeds", fmt::format("1..{}", t.others.size())}});
    settings["frames"] = kFrames;
    settings["step_degrees"] = degrees_of(2);
    settings["lowest_view_degrees"] = kLowestView;
    settings["highest_view_degrees"] = kHighestView;
    StudyPage page = page_about(kName, settings);
    page.news = {sentence(kName, "news")};
    for (const Turns& t : all) {
        page.findings.push_back(finding_of_turn(t));
        page.findings.push_back(finding_of_choice(t));
        page.claims.push_back(claim_of_every_frame(t));
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (StudyTable& table : tables_of(i + 1, all[i])) page.tables.push_back(std::move(table));
        page.plots.push_back(plot_of(i + 1, all[i]));
    }
    return page;
}

}  // namespace raya
