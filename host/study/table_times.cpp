// Table 2: what the image takes on the SPA with all its PEs and with one, and what it takes here.
#include "host/study/measured.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr double kUndisplayedMs = paper::kTotalMs - paper::kDisplayMs;          // [D]
constexpr double kOneUndisplayedMs = paper::kOnePeTotalMs - paper::kDisplayMs;  // [D]

struct Times {
    std::string scene{};
    std::uint32_t size = 0;
    double factor = 1;
    ModelledTime array, array_fitted, one, one_fitted;
    Measured reference, fp32, spa22;
};

Times times_of(Laboratory& lab, const LabelledScene& scene, std::uint32_t size) {
    const SpaRun array = run_on_spa(lab.session(), scene, size, size, 16 % size);
    const SpaRun one = run_on_spa(lab.session(), scene, size, 1, 0);
    const double factor = fitted_factor(array.cost.front());
    return {.scene = scene.label,
            .size = size,
            .factor = factor,
            .array = spa_time(array),
            .array_fitted = spa_time(array, factor),
            .one = spa_time(one),
            .one_fitted = spa_time(one, factor),
            .reference = measure_reference(scene, size),
            .fp32 = measure_device(lab.session(), scene, size, {}),
            .spa22 = measure_device(lab.session(), scene, size, machine_named("spa").format)};
}

std::vector<Comparison> comparisons_of(const Times& t) {
    const auto paper = [&](double value) { return printed(value, t.scene, t.size); };
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
        {"factor", "", std::nullopt, t.factor,
         "the only figure that is fitted, on the line above; Tables 3 and 4 use it too"},
        {"speed-up of computing", "", paper(paper::kSpeedup16), t.one.compute_ms / t.array.compute_ms,
         "needs no factor"},
        {"speed-up of all but display" + fitted, "", paper(kOneUndisplayedMs / kUndisplayedMs),
         t.one_fitted.total_ms / t.array_fitted.total_ms, "[D]"},
        {"one processor, 64 bits", "ms", paper(paper::kPcMs), t.reference.min_ms,
         "the paper's PC; ours: this machine, measured, one thread of the reference"},
        {"the same beside the workstation", "ms", paper(paper::kWorkstationMs), t.reference.min_ms,
         "the paper's workstation; ours as above"}};
}

struct Row {
    std::string machine, figures;
    Cell objects, compute, image, total;
};

Row modelled(const std::string& machine, const std::string& kind, const ModelledTime& t) {
    return {machine, kind, t.objects_ms, t.compute_ms, t.image_ms, t.total_ms};
}

Row by_paper(const std::string& machine, double objects, double compute, double image) {
    return {"paper: " + machine, "printed", objects, compute, image, objects + compute + image};
}

std::vector<Row> rows_of(const Times& t, const std::string& device) {
    std::vector<Row> rows;
    if (as_in_paper(t.scene, t.size))
        rows = {by_paper("PC, 50 ns, 64 bits", 0, paper::kPcMs, 0),
                by_paper("workstation, 25 ns, 64 bits", 0, paper::kWorkstationMs, 0),
                by_paper("SPA, 256 PEs", paper::kObjectsMs, paper::kComputeMs, paper::kImageMs),
                by_paper("SPA, 1 PE", paper::kObjectsMs, paper::kOnePeComputeMs, paper::kImageMs)};
    const std::string array = fmt::format("SPA, {} PEs", t.size), fitted = fmt::format("modelled x {:.3f}", t.factor);
    rows.push_back(modelled(array, "modelled", t.array));
    rows.push_back(modelled(array, fitted, t.array_fitted));
    rows.push_back(modelled("SPA, 1 PE", "modelled", t.one));
    rows.push_back(modelled("SPA, 1 PE", fitted, t.one_fitted));
    const auto measured = [&](const std::string& what, const Measured& m) {
        rows.push_back({"here: " + what, fmt::format("measured, least of {}", m.runs), "-", m.min_ms, "-", m.min_ms});
        rows.push_back(
            {"here: " + what, fmt::format("measured, median of {}", m.runs), "-", m.median_ms, "-", m.median_ms});
    };
    measured("reference, 64 bits, 1 thread", t.reference);
    measured(device + ", fp32", t.fp32);
    measured(device + ", " + format_name(machine_named("spa").format), t.spa22);
    return rows;
}

std::string ratio_words(double ratio) {
    return ratio >= 1 ? fmt::format("{:.3g} times slower than", ratio)
                      : fmt::format("{:.3g} times faster than", 1 / ratio);
}

std::vector<std::string> findings_of(const Times& t) {
    const double cycle_ns = machine_named("spa").cycle_ns.value();
    std::vector<std::string> findings = {
        fmt::format(
            "{} PEs compute {:.1f} times faster than one; of the whole job, display left out, {:.1f} times is left "
            "with the fitted times, since bringing the image to the host takes {:.0f} ms with any number of PEs.",
            t.size, t.one.compute_ms / t.array.compute_ms, t.one_fitted.total_ms / t.array_fitted.total_ms,
            t.array.image_ms),
        fmt::format("A pixel takes one PE {:.0f} cycles by the instruction budget; the paper's took {:.0f}, {:.2f} "
                    "times as many. Ours is not the paper's scene, so the factor holds what its scene had more or less "
                    "as well as what the budget does not see.",
                    1e6 * t.one.compute_ms / (cycle_ns * t.size * t.size),
                    1e6 * paper::kOnePeComputeMs / (cycle_ns * paper::kSize * paper::kSize), t.factor)};
    if (as_in_paper(t.scene, t.size))
        findings.push_back(fmt::format(
            "With that one factor the array's computing comes to {:.0f} ms beside the printed {:.0f} ({:+.1f} %): what "
            "is left is the difference in balance.",
            t.array_fitted.compute_ms, paper::kComputeMs, 100 * (t.array_fitted.compute_ms / paper::kComputeMs - 1)));
    findings.push_back(
        fmt::format("Measured here: one thread in 64 bits takes {:.0f} ms, the device's kernels {:.0f} ms in fp32 and "
                    "{:.0f} ms in the SPA's format; one thread is {} the SPA's modelled computing, fitted.",
                    t.reference.min_ms, t.fp32.min_ms, t.spa22.min_ms,
                    ratio_words(t.reference.min_ms / t.array_fitted.compute_ms)));
    return findings;
}

}  // namespace

StudyPage study_table2(Laboratory& lab, const Scenes& scenes) {
    const LabelledScene scene = one_of(scenes);
    const std::uint32_t size = lab.size(256);
    const std::string& device = lab.session().device().name;
    const Times t = times_of(lab, scene, size);
    StudyPage page = page_about("table2", {{"scene", scene.label},
                                           {"size", size},
                                           {"pes", std::vector{size, 1u}},
                                           {"offset", 16 % size},
                                           {"format", format_name(format_for(scene.scene))},
                                           {"factor", t.factor},
                                           {"device", device}});
    page.comparisons = comparisons_of(t);
    page.findings = findings_of(t);
    page.tables = {table_of("table2", "Times, display not included", rows_of(t, device),
                            {{"machine", &Row::machine},
                             {"figures", &Row::figures},
                             {"objects", &Row::objects, "ms"},
                             {"compute", &Row::compute, "ms"},
                             {"image transfer", &Row::image, "ms"},
                             {"total", &Row::total, "ms"}})};
    return page;
}

}  // namespace raya
