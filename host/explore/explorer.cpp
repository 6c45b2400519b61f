#include "host/explore/explorer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string_view>

#include "host/base/encoding.hpp"
#include "host/base/json.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/explore/cost_bytes.hpp"
#include "host/explore/figures.hpp"
#include "host/image/plain_png.hpp"
#include "host/page/html.hpp"
#include "host/page/html_document.hpp"
#include "host/report/text_tables.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/references.hpp"

namespace raya {
namespace {

std::string asset(const std::string& name) { return "host/explore/assets/" + name; }

// Every {{key}} of the template once, and no {{key}} of what is put in.
std::string filled(const std::string& page, const std::map<std::string, std::string>& html) {
    std::string text;
    std::size_t from = 0;
    for (std::size_t at = page.find("{{"); at != std::string::npos; at = page.find("{{", from)) {
        const std::size_t end = page.find("}}", at);
        text += page.substr(from, at - from) + html.at(page.substr(at + 2, end - at - 2));
        from = end + 2;
    }
    return text + page.substr(from);
}

std::string mapping_option(const raya_mapping& m) {
    const bool block = m.kind == RAYA_FOLD_BLOCK;
    return fmt::format("--mapping {} --pes {}{}", mapping_text(m), m.pes, block ? " --fold block" : "");
}

// The divisor of a side that is nearest to 8 from below: tiles to begin with.
std::uint32_t usual_tile(std::uint32_t side) {
    std::uint32_t tile = 1;
    for (std::uint32_t d = 2; d <= 8; ++d)
        if (side % d == 0) tile = d;
    return tile;
}

// What the controls say at first: those of the other mappings have what is usual.
Json state_of(const raya_mapping& m) {
    const auto pair = [](std::uint32_t word) { return std::vector{raya_first_of(word), raya_second_of(word)}; };
    const std::string text = mapping_text(m);
    const raya_mapping grid = squarest_grid(m.width, m.height, m.pes);
    return {{"mapping", text.substr(0, text.find(':'))},
            {"offset", raya_has_slots(m) ? m.parameter : root_offset(m.pes) % m.width},
            {"fold", m.kind == RAYA_FOLD_BLOCK ? "block" : "cyclic"},
            {"pes", m.pes},
            {"grid", pair(m.kind == RAYA_GRID ? m.parameter : grid.parameter)},
            {"tile", m.kind == RAYA_TILES ? pair(m.parameter) : std::vector{usual_tile(m.width), usual_tile(m.height)}},
            {"seed", m.kind == RAYA_RANDOM ? m.parameter : 1}};
}

Json rates_of(const Machine& machine) {
    if (!machine.cycle_ns || !machine.link_words_per_s || !machine.rotation_sync_ms || !machine.host_words_per_s)
        return {};
    return {{"cycleNs", *machine.cycle_ns},
            {"linkWords", *machine.link_words_per_s},
            {"syncMs", *machine.rotation_sync_ms}};
}

// Within a script element nothing may look like its end.
std::string about_json(const Exploration& e) {
    const Json about = {{"width", e.mapping.width},       {"height", e.mapping.height},
                        {"bytes", bytes_of_cost(e.cost)}, {"state", state_of(e.mapping)},
                        {"rates", rates_of(e.machine)},   {"command", e.command}};
    return replaced(about.dump(), "<", "\\u003c");
}

std::string offsets_html(const Exploration& e) {
    std::vector<std::uint32_t> offsets(e.mapping.width);
    std::iota(offsets.begin(), offsets.end(), 0u);
    const bool folds = e.mapping.pes != e.mapping.width;
    const auto cyclic = imbalance_of_offsets(e.cost, e.mapping.pes, RAYA_FOLD_CYCLIC, offsets),
               block = folds ? imbalance_of_offsets(e.cost, e.mapping.pes, RAYA_FOLD_BLOCK, offsets) : cyclic;
    TextCells cells = {folds ? std::vector<std::string>{"p", "u, fold cyclic", "u, fold block"}
                             : std::vector<std::string>{"p", "u"}};
    for (const std::uint32_t p : offsets) {
        cells.push_back({fmt::format("{}", p), fmt::format("{:.3f}", cyclic[p])});
        if (folds) cells.back().push_back(fmt::format("{:.3f}", block[p]));
    }
    return html_table({"u of every offset", cells});
}

std::string reference_html() {
    for (const Reference& reference : references())
        if (reference.authors == "Kohata & Ito") return html_prose(reference.full);
    return {};
}

// Of a command: options break between lines, not within.
std::string words_html(const std::string& command) {
    return "<span>" + replaced(html_text(command), " ", "</span> <span>") + "</span>";
}

std::map<std::string, std::string> parts_of(const Exploration& e) {
    const raya_mapping& m = e.mapping;
    std::map<std::string, std::string> parts;
    for (const auto& [name, text] : figure_texts(figures_of(e.cost, m, e.machine))) parts[name] = html_text(text);
    const auto number = [](std::uint64_t value) { return fmt::format("{}", value); };
    parts["scene"] = html_text(e.scene);
    parts["width"] = number(m.width);
    parts["height"] = number(m.height);
    parts["pixels"] = number(std::uint64_t{m.width} * m.height);
    parts["last_offset"] = number(m.width - 1);
    parts["usual_pes"] = number(m.width);
    parts["usual_root"] = number(root_offset(m.width) % m.width);
    parts["few_pes"] = number(std::min(m.height, m.width));
    parts["render"] = html_text(e.settings);
    parts["total"] = grouped_text(total_cycles(e.cost)) + " cycles";
    parts["options"] = "<code>" + words_html(mapping_option(m)) + "</code>";
    parts["command"] = words_html(e.command + ' ' + mapping_option(m));
    parts["machine"] = html_text(e.machine.name);
    parts["made"] = html_prose(e.made);
    parts["reference"] = reference_html();
    parts["offsets"] = offsets_html(e);
    parts["png"] = base64(plain_png(e.image));
    parts["about"] = about_json(e);
    parts["costs"] = base64(cost_bytes(e.cost));
    return parts;
}

}  // namespace

void check_explorable(const ImageSize& size) {
    constexpr std::uint64_t kMostPixels = 2'000'000;  // the project's scenes take a byte a pixel
    if (std::uint64_t{size.width} * size.height <= kMostPixels) return;
    throw UserError(
        fmt::format("--size {}x{}: too many pixels for a page that can be sent, {} at most; remedy: a "
                    "smaller --size",
                    size.width, size.height, kMostPixels));
}

std::string explorer_html(const Exploration& e) {
    if (total_cycles(e.cost) >= kExactCycles)
        throw UserError(
            fmt::format("{}: its pixels take {} cycles, more than a page adds up exactly; remedy: a smaller "
                        "--size, fewer --bounces, or --accel bvh",
                        e.scene, total_cycles(e.cost)));
    const std::string body = filled(embedded_files().at(asset("page.html")), parts_of(e));
    std::string page = html_document({"raya explore: " + e.scene,
                                      body,
                                      {asset("style.css")},
                                      {asset("model.js"), asset("link.js"), asset("drawing.js"), asset("words.js"),
                                       asset("controls.js"), asset("explorer.js")}});
    if (page.size() <= kLargestPage) return page;
    const double less = 0.9 * std::sqrt(static_cast<double>(kLargestPage) / static_cast<double>(page.size()));
    const auto side = [less](std::uint32_t pixels) { return std::max(1, static_cast<int>(less * pixels)); };
    throw UserError(fmt::format(
        "{}: a page of {} x {} pixels would have {} bytes, {} at most so that it can be sent; remedy: --size {}x{}",
        e.scene, e.mapping.width, e.mapping.height, page.size(), kLargestPage, side(e.mapping.width),
        side(e.mapping.height)));
}

}  // namespace raya
