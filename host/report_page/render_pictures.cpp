#include <fmt/core.h>

#include <algorithm>

#include "host/base/encoding.hpp"
#include "host/image/plain_png.hpp"
#include "host/page/drawing.hpp"
#include "host/page/html.hpp"
#include "host/report_page/maps.hpp"
#include "host/report_page/read.hpp"
#include "host/report_page/render_parts.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

constexpr const char* kColours =
    "Red has more than the mean, blue less, grey as much; the fullest colour is what lies farthest from it.";

HtmlPicture preview_of_report(const Json& report) {
    const Json& image = report.at("image");
    const Json* const preview = image.find("preview");
    if (preview == nullptr) throw JsonError("it holds no small picture (image.preview)");
    const std::string& png = preview->at("png").text();
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=";
    if (!png.starts_with("iVBORw0KGgo") || png.find_first_not_of(kDigits) != std::string::npos)
        throw JsonError("image.preview.png is no PNG file in base64");
    const std::uint64_t width = image.at("width").whole(), small = preview->at("width").whole();
    const std::string size = fmt::format("{} x {} pixels", width, image.at("height").whole());
    return {
        .title = fmt::format("{}, {}{}.", text_or_nothing(image, "file"), size,
                             small < width ? fmt::format("; here {} x {}", small, preview->at("height").whole()) : ""),
        .words = "The rendered picture of " + report.at("scene").text() + ", " + size,
        .base64_png = png};
}

// "12.3 % above to 4.5 % below the mean"
std::string range_words(const Json& load) {
    const double mean = load.at("mean").number();
    if (!(mean > 0)) return "all 0";
    return fmt::format("from {} below to {} above the mean", percent_of(1 - load.at("min").number() / mean),
                       percent_of(load.at("max").number() / mean - 1));
}

HtmlPicture picture_of(const std::string& title, const std::string& words, const Image& image) {
    return {.title = title, .words = words, .base64_png = base64(plain_png(image))};
}

std::string owner_maps(const Json& report, const raya_mapping& m) {
    const std::string mapping = report.at("machine").at("mapping").text();
    const std::string range = range_words(report.at("load"));
    const Image close = owner_close_up(m);
    return html_picture(
               picture_of(fmt::format("Each pixel by the load of its PE, {}. {}", range, kColours),
                          fmt::format("A map of the picture: each pixel has the colour of its PE's load, {}", range),
                          load_map(m, numbers_of(report.at("load").at("per_pe"))))) +
           html_picture(picture_of(
               fmt::format("Owners of the upper left {} x {} pixels: hue is the number of the PE, of {}; {} mapping.",
                           close.width, close.height, m.pes, mapping),
               fmt::format("A close-up of which PE owns which pixel under the {} mapping on {} PEs", mapping, m.pes),
               close));
}

raya_torus torus_of(const Json& report) {
    const Json& t = report.at("torus");
    std::array<std::uint32_t, 3> nodes{};
    const auto& sides = t.at("nodes").elements();
    if (sides.size() != nodes.size()) throw JsonError("torus.nodes must be three numbers");
    for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = static_cast<std::uint32_t>(sides[i].whole(kMostNodes));
    return make_torus(nodes, t.at("links").text() == links_name(Links::kTorus2d) ? Links::kTorus2d : Links::kTorus3d);
}

std::vector<double> by_node(const Json& list, const raya_torus& torus) {
    std::vector<double> values = numbers_of(list);
    if (values.size() != raya_nodes(torus)) throw JsonError("a list by nodes has another length than there are nodes");
    return values;
}

std::string node_maps(const Json& report) {
    const raya_torus t = torus_of(report);
    const std::string nodes =
        fmt::format("{} x {} x {} nodes, slices of equal z beside one another", t.nodes[0], t.nodes[1], t.nodes[2]);
    const std::string range = range_words(report.at("load"));
    return html_picture(picture_of(fmt::format("The load of each of {}, {}. {}", nodes, range, kColours),
                                   fmt::format("A map of {}, each in the colour of its load, {}", nodes, range),
                                   node_map(t, by_node(report.at("load").at("per_pe"), t)))) +
           html_picture(
               picture_of(fmt::format("Bytes that each node sends over its links, {}. {}", nodes, kColours),
                          fmt::format("A map of {}, each in the colour of the bytes that it sends", nodes),
                          node_map(t, by_node(report.at("torus").at("bytes_per_link").at("sent_by_node"), t))));
}

std::string parts_name(const Json& report) { return report.find("torus") != nullptr ? "node" : "PE"; }

}  // namespace

std::string pictures_html(const Json& report, const std::optional<raya_mapping>& mapping) {
    std::string html = html_picture(preview_of_report(report));
    if (report.find("torus") != nullptr)
        html += node_maps(report);
    else if (mapping)
        html += owner_maps(report, *mapping);
    html = "<div class=\"pictures\">\n" + html + "</div>\n";
    if (report.at("load").find("requests") != nullptr)
        html +=
            "<p class=\"note\">PEs take their pixels while the machine runs, so that no rule says who owns which; "
            "loads are simulated exactly on the pixels' costs.</p>\n";
    return html;
}

std::string loads_html(const Json& report) {
    const Json& load = report.at("load");
    const std::vector<double> loads = numbers_of(load.at("per_pe"));
    if (loads.empty()) throw JsonError("load.per_pe is empty");
    if (*std::min_element(loads.begin(), loads.end()) < 0) throw JsonError("load.per_pe has a number below 0");
    const double mean = load.at("mean").number();
    const std::string part = parts_name(report);
    const DrawingWords words{
        .id = "load-bars",
        .title = fmt::format("The load of each {}: modelled cycles, the line at their mean.", part),
        .across = "number of the " + part,
        .up = "cycles",
        .series = fmt::format("{} loads from {:.0f} to {:.0f}, mean {:.1f}", loads.size(), load.at("min").number(),
                              load.at("max").number(), mean)};
    TextCells cells = {{part, "cycles", "of the mean"}};
    for (std::size_t i = 0; i < loads.size(); ++i)
        cells.push_back(
            {fmt::format("{}", i), fmt::format("{:.0f}", loads[i]), mean > 0 ? percent_of(loads[i] / mean) : "-"});
    std::string phases;
    for (const std::string& key : load.keys())
        if (const Json* const u = load.at(key).find("imbalance"))
            phases += fmt::format("{}{}: u = {:.3f}, speed-up {:.1f}", phases.empty() ? "" : "; ", key, u->number(),
                                  load.at(key).at("speedup").number());
    return fmt::format(
               "<p>u = (max - mean) / mean = {:.3f}. Each {} adds up the events that its rays counted, times what "
               "each costs by the machine's instruction budget.{}</p>\n",
               load.at("imbalance").number(), part, phases.empty() ? "" : " By phase: " + html_prose(phases) + ".") +
           html_bars(words, loads, mean) +
           html_folded_table({fmt::format("The load of each {}", part), html_cells(cells)},
                             "All of them stand in the report as <code>load.per_pe</code>.");
}

std::string traffic_html(const Json& report) {
    const Json* const t = report.find("torus");
    if (t == nullptr) return {};
    const Json& link = t->at("bytes_per_link");
    const std::vector<double> directions = numbers_of(link.at("by_direction"));
    constexpr std::array<const char*, RAYA_LINKS> kNames = {"+x", "-x", "+y", "-y", "+z", "-z"};
    if (directions.size() != kNames.size()) throw JsonError("torus.bytes_per_link.by_direction must be six numbers");
    std::vector<NamedBar> bars;
    for (std::size_t i = 0; i < kNames.size(); ++i)
        bars.push_back({kNames[i], fmt::format("{:.3g} MB", 1e-6 * directions[i]), directions[i]});
    TextCells cells = {{"packets", "made", "ended"}};
    const Json& packets = t->at("packets");
    for (const std::string& kind : packets.keys())
        cells.push_back({kind, count_of(packets.at(kind).at("made")), count_of(packets.at(kind).at("ended"))});
    return html_tiles({{"hops", count_of(t->at("hops"))},
                       {"bytes over links", count_of(link.at("total"))},
                       {"busiest link", count_of(link.at("max")) + " bytes"},
                       {"mean of links", fixed(link.at("mean").number(), 0) + " bytes"},
                       {"supersteps", count_of(t->at("supersteps"))}}) +
           html_named_bars({.id = "link-bars",
                            .title = "Bytes over the links of all nodes, by direction on the torus.",
                            .across = "bytes",
                            .up = "direction",
                            .series = "one bar for each of six directions"},
                           bars) +
           html_table({"Packets", html_cells(cells)});
}

}  // namespace raya
