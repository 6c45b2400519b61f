#include <fmt/core.h>

#include <algorithm>
#include <functional>

#include "host/model/unit_text.hpp"
#include "host/page/drawing.hpp"
#include "host/page/html.hpp"
#include "host/report_page/read.hpp"
#include "host/report_page/render_parts.hpp"

namespace raya {
namespace {

const std::vector<Json>& commands_of(const Json& report) { return report.at("measured").at("commands").elements(); }

using Labels = std::function<bool(const std::string&)>;

// One line of model beside measurement: what the model calls it, and the labels of commands that do it here.
struct ModelLine {
    std::string name, key, what;
    Labels labels;
};

Labels any_of(std::vector<std::string> begins) {
    return [begins = std::move(begins)](const std::string& label) {
        return std::ranges::any_of(begins, [&](const std::string& begin) { return label.starts_with(begin); });
    };
}

std::vector<ModelLine> ring_lines() {
    return {{"objects", "objects", "the scene over the bus to all PEs", any_of({"bus.broadcast"})},
            {"compute", "compute", "tracing, and what smooths", any_of({"trace", "supersample", "filter."})},
            {"of it filter", "filter", "sums and means of neighbours", any_of({"filter."})},
            {"of it compare", "compare", "which pixels differ from a neighbour", any_of({"supersample.compare"})},
            {"communication", "communication", "neighbours' pixels over ring or bus",
             any_of({"ring.", "bus.send", "bus.pe"})},
            {"image", "image", "pixels to the host", any_of({"bus.gather"})}};
}

std::vector<ModelLine> torus_lines() {
    return {
        {"compute", "compute", "the busiest processor: making and tracing packets", any_of({"inject", "trace_voxel"})},
        {"messages", "messages", "the busiest processor: handling packets", any_of({"route", "look", "accept"})},
        {"links", "links", "the busiest link", any_of({"exchange", "return"})}};
}

// ms, and how many labels.
std::pair<double, std::string> measured(const Json& report, const Labels& labels) {
    double ns = 0;
    std::string names;
    for (const Json& c : commands_of(report)) {
        const std::string label = c.at("label").text();
        if (!labels(label)) continue;
        ns += c.at("total_ns").number();
        if (("," + names + ",").find("," + label + ",") == std::string::npos)
            names += (names.empty() ? "" : ",") + label;
    }
    return {1e-6 * ns, replaced(names, ",", ", ")};
}

std::string ms_text(double ms) { return ms > 0 && ms < 1 ? fmt::format("{:.3f} ms", ms) : time_text(ms); }

TextCells model_cells(const Json& report, const Json& model) {
    const bool torus = report.find("torus") != nullptr;
    TextCells cells = {{"part", "what", "modelled", "here", "commands here"}};
    for (const ModelLine& row : torus ? torus_lines() : ring_lines()) {
        const double modelled = model.at(row.key).number();
        const auto [ms, labels] = measured(report, row.labels);
        const bool part_of = row.name.starts_with("of it");
        if (part_of && modelled == 0 && labels.empty()) continue;
        cells.push_back({row.name, row.what, ms_text(modelled), labels.empty() ? "-" : ms_text(ms), labels});
    }
    const double here = 1e3 * report.at("measured").at("render_s").number();
    if (torus) {
        cells.push_back(
            {"whole, if nothing waits", "a bound from below", ms_text(model.at("overlapped").number()), "-", ""});
        cells.push_back({"whole, step by step", "a bound from above", ms_text(model.at("stepwise").number()),
                         ms_text(here), "the whole render on the host's clock"});
        if (const Json* const async = model.find("asynchronous"))
            cells.push_back({"whole, without supersteps", "simulated packet by packet",
                             ms_text(async->at("finish").number()), "-", ""});
        return cells;
    }
    cells.push_back({"whole", "all of it; what is \"of it\" lies in compute", ms_text(model.at("total").number()),
                     ms_text(here), "the whole render on the host's clock"});
    return cells;
}

}  // namespace

std::string model_html(const Json& report) {
    const Json& model = report.at("modelled_ms");
    const std::string machine = report.at("machine").at("name").text();
    if (model.is_null())
        return fmt::format("<p>The rates of {} are not known, so it has no modelled time.</p>\n", html_text(machine));
    return fmt::format(
               "<p>What the modelled machine, {}, would take by its own rates, beside what this device took for the "
               "commands that stand in for that part.</p>\n",
               html_text(report.find("torus") != nullptr ? "the torus of T805s" : machine)) +
           html_table({"Modelled beside measured time", html_cells(model_cells(report, model))});
}

std::string labels_html(const Json& report) {
    double all = 0;
    std::vector<NamedBar> bars;
    for (const Json& c : commands_of(report)) all += c.at("total_ns").number();
    TextCells cells = {{"label", "kind", "launches", "total ms", "share", "least ms", "mean ms", "most ms", "MB"}};
    for (const Json& c : commands_of(report)) {
        const double total = c.at("total_ns").number();
        const Json* const bytes = c.find("bytes");
        const auto ms = [&](const char* key) { return fixed(1e-6 * c.at(key).number(), 3); };
        const std::string share = percent_of(all > 0 ? total / all : 0), label = c.at("label").text(),
                          kind = c.at("kind").text();
        cells.push_back({label, kind, count_of(c.at("launches")), ms("total_ns"), share, ms("min_ns"), ms("mean_ns"),
                         ms("max_ns"),
                         bytes == nullptr || bytes->number() == 0 ? "-" : fixed(1e-6 * bytes->number(), 3)});
        bars.push_back({fmt::format("{} ({})", label, kind), fmt::format("{} ms", ms("total_ns")), total});
    }
    if (bars.empty()) return "<p>The device does not time its commands.</p>\n";
    constexpr std::size_t kMostBars = 8;
    std::ranges::stable_sort(bars, [](const NamedBar& a, const NamedBar& b) { return a.value > b.value; });
    bars.resize(std::min(bars.size(), kMostBars));
    const Json& m = report.at("measured");
    return fmt::format(
               "<p>The render took {} on the host's clock, the build of its kernels {} before it. Times of commands "
               "are "
               "the device's, from start to end.</p>\n",
               time_text(1e3 * m.at("render_s").number()), time_text(1e3 * m.at("build_s").number())) +
           html_named_bars({.id = "label-bars",
                            .title = "Commands of the device by their total time, the longest.",
                            .across = "time",
                            .up = "label and kind",
                            .series = fmt::format("{} labels", bars.size())},
                           bars) +
           html_table({"Times by label", html_cells(cells)});
}

}  // namespace raya
