// Table 2: what the image takes on the SPA with all its PEs and with one, on one clock, and what it takes here.
#include <cmath>

#include "host/image/plain_png.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/measured.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

// Kohata & Ito's whole job, display and all, in the milliseconds of one PE's and of all PEs' computing.
double job_gain(double one_ms, double array_ms) {
    constexpr double kRest = paper::kObjectsMs + paper::kImageMs + paper::kDisplayMs;
    return (one_ms + kRest) / (array_ms + kRest);
}

struct Times {
    std::string scene{};
    std::uint32_t size = 0;
    SpaRun array, one;
    Measured reference, fp32, spa22;

    bool in_paper() const { return as_in_paper(scene, size); }
    double speedup() const { return array.phases.front().speedup; }
    double one_ms(double factor) const { return spa_time(one, factor).compute_ms; }
    double array_ms(double factor) const { return spa_time(array, factor).compute_ms; }
    double gain(double factor) const { return job_gain(one_ms(factor), array_ms(factor)); }
    // With what one PE took by Table 2: our balance, and no clock of ours.
    double gain_by_balance() const { return job_gain(paper::kOnePeComputeMs, paper::kOnePeComputeMs / speedup()); }
};

Times times_of(Laboratory& lab, const LabelledScene& scene, std::uint32_t size) {
    return {.scene = scene.label,
            .size = size,
            .array = run_on_spa(lab.session(), scene, size, size, 16 % size),
            .one = run_on_spa(lab.session(), scene, size, 1, 0),
            .reference = measure_reference(scene, size),
            .fp32 = measure_device(lab.session(), scene, size, {}),
            .spa22 = measure_device(lab.session(), scene, size, machine_named("spa").format)};
}

std::vector<Comparison> comparisons_of(const Times& t) {
    const auto paper = [&](double value) { return printed(value, t.scene, t.size); };
    const std::string pes = fmt::format("{} PEs: ", t.size);
    const double factor = machine_factor().value;
    const ModelledTime array = spa_time(t.array, factor), one = spa_time(t.one, factor);
    const char* const display = "with the printed display of 1,130 ms";
    return {{pes + "objects", "ms", paper(paper::kObjectsMs), array.objects_ms, "words over the host's rate"},
            {pes + "compute", "ms", paper(paper::kComputeMs), array.compute_ms, "another scene than ours"},
            {pes + "image transfer", "ms", paper(paper::kImageMs), array.image_ms,
             "the host's rate is this printed figure's"},
            {pes + "total", "ms", paper(paper::kTotalMs), array.total_ms + paper::kDisplayMs, display},
            {"1 PE: compute", "ms", paper(paper::kOnePeComputeMs), one.compute_ms, "another scene than ours"},
            {"1 PE: total", "ms", paper(paper::kOnePeTotalMs), one.total_ms + paper::kDisplayMs, display},
            {"cycles a pixel", "", paper(1e6 * paper::kOnePeComputeMs / (100 * factor * paper::kSize * paper::kSize)),
             1e6 * one.compute_ms / (100 * factor * t.size * t.size), "of the budget; the paper's by this clock",
             Source::kDerived},
            {"speed-up of computing", "", paper(paper::kSpeedup16), t.speedup(), "needs no clock"},
            {"speed-up of the whole job", "", paper(paper::kOnePeTotalMs / paper::kTotalMs), t.gain_by_balance(),
             "our balance, the printed times of one PE, transfers and display", Source::kDerived},
            {"one processor, 64 bits", "ms", paper(paper::kPcMs), t.reference.min_ms,
             "the paper's PC; ours: this machine, measured, one thread of the reference"},
            {"the same beside the workstation", "ms", paper(paper::kWorkstationMs), t.reference.min_ms,
             "the paper's workstation; ours as above"}};
}

struct Row {
    std::string machine, figures;
    Cell objects, compute, image, display, total;
};

Row modelled(const std::string& machine, const ModelledTime& t) {
    return {
        machine, "modelled", t.objects_ms, t.compute_ms, t.image_ms, paper::kDisplayMs, t.total_ms + paper::kDisplayMs};
}

Row by_paper(const std::string& machine, double objects, double compute, double image, double display) {
    return {"Kohata & Ito: " + machine,         "printed", objects, compute, image, display,
            objects + compute + image + display};
}

std::vector<Row> rows_of(const Times& t, const std::string& device) {
    std::vector<Row> rows;
    constexpr double kWorkstationDisplayMs = 300;
    if (t.in_paper())
        rows = {by_paper("PC, 50 ns, 64 bits", 0, paper::kPcMs, 0, paper::kDisplayMs),
                by_paper("workstation, 25 ns, 64 bits", 0, paper::kWorkstationMs, 0, kWorkstationDisplayMs),
                by_paper("SPA, 256 PEs", paper::kObjectsMs, paper::kComputeMs, paper::kImageMs, paper::kDisplayMs),
                by_paper("SPA, 1 PE", paper::kObjectsMs, paper::kOnePeComputeMs, paper::kImageMs, paper::kDisplayMs)};
    const double factor = machine_factor().value;
    rows.push_back(modelled(fmt::format("SPA, {} PEs", t.size), spa_time(t.array, factor)));
    rows.push_back(modelled("SPA, 1 PE", spa_time(t.one, factor)));
    const auto measured = [&](const std::string& what, const Measured& m) {
        const auto add = [&](const char* which, double ms) {
            rows.push_back(
                {"here: " + what, fmt::format("measured warm, {} of {}", which, m.runs), "-", ms, "-", "-", ms});
        };
        add("least", m.min_ms);
        add("median", m.median_ms);
        add("largest", m.max_ms);
    };
    measured("reference, 64 bits, 1 thread", t.reference);
    measured(device + ", fp32", t.fp32);
    measured(device + ", " + format_name(machine_named("spa").format), t.spa22);
    return rows;
}

// What one factor of the clock makes of the job.
struct AtFactor {
    double factor, one_ms, array_ms, gain;
};

std::vector<AtFactor> sensitivity_of(const Times& t) {
    return each(kFactors, [&](double factor) {
        return AtFactor{factor, t.one_ms(factor), t.array_ms(factor), t.gain(factor)};
    });
}

// A figure of the host model, and one that it predicts.
struct HostRow {
    std::string what, unit;
    Interval value;
    double least() const { return value.least; }
    double most() const { return value.most; }
};

std::vector<HostRow> host_rows(const Times& t) {
    const HostModel model = host_model();
    const auto words = static_cast<double>(t.array.communication.broadcast_words);
    return {{"set-up of a call", "ms", model.setup_ms},
            {"rotation of 768 words", "ms", model.rotation_ms},
            {"rate of the host", "words/s", model.words_per_s},
            {fmt::format("objects of our scene, {:.0f} words", words), "ms", model.call_ms(words)}};
}

std::vector<Claim> claims_of(const Times& t) {
    constexpr double kPrinted = paper::kOnePeTotalMs / paper::kTotalMs, kNear = 0.05;
    const double gain = t.gain_by_balance();
    const bool near = std::abs(gain / kPrinted - 1) <= kNear;
    return {{paper::kSpa, "Table 2",
             "The whole job, display included, is 42.5 times faster on 256 PEs than on one (derived).",
             verdict_of(near, !near),
             finding("table2", "job", "gain"_a = gain, "printed"_a = kPrinted, "near"_a = 100 * kNear,
                     "display"_a = 100 * paper::kDisplayMs / paper::kTotalMs)}};
}

std::string ratio_words(double ratio) {
    return ratio >= 1 ? fmt::format("{:.3g} times slower than", ratio)
                      : fmt::format("{:.3g} times faster than", 1 / ratio);
}

std::vector<std::string> findings_of(const Times& t) {
    const double factor = machine_factor().value;
    const auto factors = sensitivity_of(t);
    const Measured& m = t.spa22;
    const Interval objects = host_rows(t).back().value;
    return {finding("table2", "gain", "pes"_a = t.size, "speedup"_a = t.speedup(), "gain"_a = t.gain(factor),
                    "least"_a = factors.front().gain, "most"_a = factors.back().gain),
            finding("table2", "objects", "least"_a = objects.least, "most"_a = objects.most),
            finding("table2", "cycles", "cycles"_a = 1e6 * t.one_ms(1) / (100.0 * t.size * t.size)),
            finding("table2", "measured", "reference"_a = t.reference.min_ms, "fp32"_a = t.fp32.min_ms,
                    "spa22"_a = m.min_ms, "spread"_a = 100 * (m.max_ms / m.min_ms - 1), "runs"_a = m.runs,
                    "ratio"_a = ratio_words(t.reference.min_ms / t.array_ms(factor)))};
}

std::vector<StudyTable> tables_of(const Times& t, const std::string& device) {
    return {table_of("table2", "Times", rows_of(t, device),
                     {{"machine", &Row::machine},
                      {"figures", &Row::figures},
                      {"objects", &Row::objects, "ms"},
                      {"compute", &Row::compute, "ms"},
                      {"image transfer", &Row::image, "ms"},
                      {"display", &Row::display, "ms"},
                      {"total", &Row::total, "ms"}}),
            table_of("table2-factors", "The job by the clock's factor", sensitivity_of(t),
                     {{"factor", &AtFactor::factor},
                      {"1 PE: compute", &AtFactor::one_ms, "ms"},
                      {"all PEs: compute", &AtFactor::array_ms, "ms"},
                      {"speed-up of the whole job", &AtFactor::gain}}),
            table_of("table2-host", "What a call of the host takes, by the rounding of the printed 2, 12 and 140 ms",
                     host_rows(t),
                     {{"what", &HostRow::what},
                      {"unit", &HostRow::unit},
                      {"least", &HostRow::least},
                      {"largest", &HostRow::most}})};
}

// The picture that the array made: beside Fig. 6, whose objects are not printed.
std::vector<StudyPicture> pictures_of(const Times& t) {
    return {{"table2-picture", fmt::format("{} at {} x {}, as the PEs made it", t.scene, t.size, t.size),
             t.scene == "centre" ? "glass and mirror spheres crowded in the middle above a checkered plane"
                                 : "the scene that was named",
             plain_png(t.array.image)}};
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
                                           {"factor", machine_factor().value},
                                           {"device", device}});
    page.clock = clock_text();
    page.comparisons = comparisons_of(t);
    if (t.in_paper()) page.claims = claims_of(t);
    page.findings = findings_of(t);
    page.tables = tables_of(t, device);
    page.pictures = pictures_of(t);
    page.news = {sentence("table2", "news")};
    return page;
}

}  // namespace raya
