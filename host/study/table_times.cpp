// Table 2: what the image takes on the SPA with all its PEs and with one, and what it takes here.
#include <fmt/format.h>

#include "host/ring/schedule.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/measured.hpp"
#include "host/study/paper.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr double kUndisplayedMs = paper::kTotalMs - paper::kDisplayMs;          // [D]
constexpr double kOneUndisplayedMs = paper::kOnePeTotalMs - paper::kDisplayMs;  // [D]

struct Times {
    std::uint32_t size = 0;
    double factor = 1;
    ModelledTime array, array_fitted, one, one_fitted;
    Measured reference, fp32, spa22;
};

Times times_of(Laboratory& lab, const LabelledScene& scene, std::uint32_t size) {
    const SpaRun array = run_on_spa(lab.session(), scene, size, size, 16 % size);
    const SpaRun one = run_on_spa(lab.session(), scene, size, 1, 0);
    Times t;
    t.size = size;
    t.factor = fitted_factor(array.cost.front());
    t.array = spa_time(array);
    t.array_fitted = spa_time(array, t.factor);
    t.one = spa_time(one);
    t.one_fitted = spa_time(one, t.factor);
    t.reference = measure_reference(scene, size);
    t.fp32 = measure_device(lab.session(), scene, size, {});
    t.spa22 = measure_device(lab.session(), scene, size, machine_named("spa").format);
    return t;
}

std::vector<Comparison> comparisons_of(const Times& t) {
    const auto paper = [&](double value) { return printed(value, t.size); };
    const std::string array = fmt::format("{} PEs: ", t.size), fitted = ", fitted";
    const std::string shown = "without display [D]";
    return {
        {array + "objects", "ms", paper(paper::kObjectsMs), t.array.objects_ms, "modelled; words over the host's rate"},
        {array + "compute", "ms", paper(paper::kComputeMs), t.array.compute_ms, "modelled, nothing fitted"},
        {array + "compute" + fitted, "ms", paper(paper::kComputeMs), t.array_fitted.compute_ms,
         "modelled, times the factor"},
        {array + "image transfer", "ms", paper(paper::kImageMs), t.array.image_ms,
         "the host's rate is this printed figure's"},
        {array + "total", "ms", paper(kUndisplayedMs), t.array.total_ms, shown},
        {array + "total" + fitted, "ms", paper(kUndisplayedMs), t.array_fitted.total_ms, shown},
        {"1 PE: compute", "ms", paper(paper::kOnePeComputeMs), t.one.compute_ms, "modelled, nothing fitted"},
        {"1 PE: compute" + fitted, "ms", paper(paper::kOnePeComputeMs), t.one_fitted.compute_ms, "equal by the fit"},
        {"1 PE: total" + fitted, "ms", paper(kOneUndisplayedMs), t.one_fitted.total_ms, shown},
        {"factor", "", {}, t.factor, "the only figure that is fitted, on the line above; Tables 3 and 4 use it too"},
        {"speed-up of computing", "", paper(paper::kSpeedup16), t.one.compute_ms / t.array.compute_ms,
         "needs no factor"},
        {"speed-up of all but display" + fitted, "", paper(kOneUndisplayedMs / kUndisplayedMs),
         t.one_fitted.total_ms / t.array_fitted.total_ms, "[D]"},
        {"one processor, 64 bits", "ms", paper(paper::kPcMs), t.reference.min_ms,
         "the paper's PC; ours: this machine, measured, one thread of the reference"},
        {"the same beside the workstation", "ms", paper(paper::kWorkstationMs), t.reference.min_ms,
         "the paper's workstation; ours as above"}};
}

using Row = std::vector<Cell>;

Row modelled_row(const std::string& machine, const std::string& kind, const ModelledTime& t) {
    return {machine, kind, t.objects_ms, t.compute_ms, t.image_ms, t.total_ms};
}

Row paper_row(const std::string& machine, double objects, double compute, double image) {
    return {machine, std::string("printed"), objects, compute, image, objects + compute + image};
}

StudyTable times_table(const Times& t, const std::string& device) {
    StudyTable table{"table2",
                     "Times, display not included",
                     {"machine", "figures", "objects (ms)", "compute (ms)", "image transfer (ms)", "total (ms)"},
                     {},
                     true};
    if (printed(0, t.size))
        table.rows = {paper_row("paper: PC, 50 ns, 64 bits", 0, paper::kPcMs, 0),
                      paper_row("paper: workstation, 25 ns, 64 bits", 0, paper::kWorkstationMs, 0),
                      paper_row("paper: SPA, 256 PEs", paper::kObjectsMs, paper::kComputeMs, paper::kImageMs),
                      paper_row("paper: SPA, 1 PE", paper::kObjectsMs, paper::kOnePeComputeMs, paper::kImageMs)};
    const std::string array = fmt::format("SPA, {} PEs", t.size), fitted = fmt::format("modelled x {:.3f}", t.factor);
    table.rows.push_back(modelled_row(array, "modelled", t.array));
    table.rows.push_back(modelled_row(array, fitted, t.array_fitted));
    table.rows.push_back(modelled_row("SPA, 1 PE", "modelled", t.one));
    table.rows.push_back(modelled_row("SPA, 1 PE", fitted, t.one_fitted));
    const auto measured = [&](const std::string& what, const Measured& m) {
        const std::string none = "-";
        table.rows.push_back({what, fmt::format("measured, least of {}", m.runs), none, m.min_ms, none, m.min_ms});
        table.rows.push_back(
            {what, fmt::format("measured, median of {}", m.runs), none, m.median_ms, none, m.median_ms});
    };
    measured("here: reference, 64 bits, 1 thread", t.reference);
    measured(fmt::format("here: {}, fp32", device), t.fp32);
    measured(fmt::format("here: {}, {}", device, format_name(machine_named("spa").format)), t.spa22);
    return table;
}

std::string ratio_words(double ratio) {
    return ratio >= 1 ? fmt::format("{:.3g} times slower than", ratio)
                      : fmt::format("{:.3g} times faster than", 1 / ratio);
}

std::vector<std::string> findings_of(const Times& t) {
    const double speedup = t.one.compute_ms / t.array.compute_ms;
    std::vector<std::string> findings = {
        fmt::format("{} PEs compute {:.1f} times faster than one; of the whole job, display left out, {:.1f} times is "
                    "left with the fitted times, since bringing the image to the host takes {:.0f} ms with any number "
                    "of PEs.",
                    t.size, speedup, t.one_fitted.total_ms / t.array_fitted.total_ms, t.array.image_ms)};
    const double cycle_ns = machine_named("spa").cycle_ns.value();
    findings.push_back(fmt::format(
        "A pixel takes one PE {:.0f} cycles by the instruction budget; the paper's took {:.0f}, {:.2f} times as many. "
        "{}",
        1e6 * t.one.compute_ms / (cycle_ns * t.size * t.size),
        1e6 * paper::kOnePeComputeMs / (cycle_ns * paper::kSize * paper::kSize), t.factor,
        "Ours is not the paper's scene, so the factor holds what its scene had more or less as well as what the budget "
        "does not see."));
    if (printed(0, t.size))
        findings.push_back(fmt::format(
            "With that one factor the array's computing comes to {:.0f} ms beside the "
            "printed {:.0f} ({:+.1f} %): what is left is the difference in balance.",
            t.array_fitted.compute_ms, paper::kComputeMs, 100 * (t.array_fitted.compute_ms / paper::kComputeMs - 1)));
    findings.push_back(fmt::format(
        "Measured here: one thread in 64 bits takes {:.0f} ms, the device's kernels {:.0f} ms in fp32 and {:.0f} ms in "
        "the SPA's format; one thread is {} the SPA's modelled computing, fitted.",
        t.reference.min_ms, t.fp32.min_ms, t.spa22.min_ms,
        ratio_words(t.reference.min_ms / t.array_fitted.compute_ms)));
    return findings;
}

}  // namespace

StudyPage study_table2(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const LabelledScene scene = scenes.empty() ? embedded_scene("centre") : scenes.front();
    const std::uint32_t size = lab.size(256);
    const Times t = times_of(lab, scene, size);
    StudyPage page;
    page.name = "table2";
    page.title = "Table 2: times of the SPA and of other machines";
    page.question = "How long does one image take on the SPA with all its PEs and with one, and how long here?";
    page.method = {
        fmt::format("{} at {} x {}; SPA with {} PEs, a PE for each column, p = {}, and with one. Rendered for both; "
                    "their events, words and transfers are counted, times are modelled from them.",
                    scene.label, size, size, size, 16 % size),
        "Display is not modelled: the printed 1,130 ms (SPA, PC), 300 ms (workstation) are left out of all totals.",
        "The factor makes one PE's modelled time per pixel that of the paper, and multiplies computing only.",
        "Measured: the reference renders in double precision on one thread; the device's time is that of its kernels, "
        "without their build and transfers."};
    page.comparisons = comparisons_of(t);
    page.tables = {times_table(t, lab.session().device().name)};
    page.findings = findings_of(t);
    page.settings = {{"scene", scene.label},
                     {"size", size},
                     {"pes", {size, 1}},
                     {"offset", 16 % size},
                     {"format", format_name(format_for(scene.scene))},
                     {"factor", t.factor},
                     {"device", lab.session().device().name}};
    return page;
}

}  // namespace raya
