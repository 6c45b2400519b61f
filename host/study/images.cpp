// Efficiency of the column split and of the cyclic mapping over ten scenes and two image sizes.
#include "host/study/images.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/ring/mapping.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/paper.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

struct Image {
    const Costs* costs;
    Load columns, cyclic;
    std::uint32_t side() const { return costs->trace.width; }
    std::string name() const { return fmt::format("{} at {} x {}", costs->label, side(), side()); }
};

struct Range {
    double least = 1, most = 0;
    double width() const { return most - least; }
};

using Pick = Load Image::*;

Range range_of(const std::vector<Image>& images, Pick pick) {
    Range range;
    for (const Image& image : images) {
        range.least = std::min(range.least, (image.*pick).efficiency);
        range.most = std::max(range.most, (image.*pick).efficiency);
    }
    return range;
}

std::vector<std::uint32_t> sides_of(const std::vector<Image>& images) {
    std::vector<std::uint32_t> sides;
    for (const Image& image : images)
        if (std::find(sides.begin(), sides.end(), image.side()) == sides.end()) sides.push_back(image.side());
    return sides;
}

double mean_of(const std::vector<Image>& images, std::uint32_t side, Pick pick) {
    double sum = 0, count = 0;
    for (const Image& image : images)
        if (image.side() == side) sum += (image.*pick).efficiency, ++count;
    return sum / count;
}

StudyTable table_of(const std::vector<Image>& images, std::uint32_t p) {
    StudyTable table{"images",
                     "Imbalance and efficiency of each image",
                     {"no.", "scene", "objects", "side (pixels)", "u, p = 0", "efficiency, p = 0",
                      fmt::format("u, p = {}", p), fmt::format("efficiency, p = {}", p)},
                     {},
                     true};
    std::int64_t number = 0;
    for (const Image& image : images)
        table.rows.push_back({++number, image.costs->label, static_cast<std::int64_t>(image.costs->objects),
                              std::int64_t{image.side()}, image.columns.imbalance, image.columns.efficiency,
                              image.cyclic.imbalance, image.cyclic.efficiency});
    return table;
}

// Scenes are numbered by their first image; every series has a point for each.
StudyPlot plot_of(const std::vector<Image>& images, std::uint32_t pes, std::uint32_t p) {
    StudyPlot plot{
        "images", "Efficiency over the scenes", "scene, by its first number in the table", "efficiency", false, false,
        {}};
    for (const Pick pick : {&Image::cyclic, &Image::columns})
        for (const std::uint32_t side : sides_of(images)) {
            const bool split = pick == &Image::columns;
            PlotSeries series{fmt::format("{} at {} x {}", split ? "p = 0" : fmt::format("p = {}", p), side, side),
                              {},
                              {},
                              PlotStyle::kPoints};
            for (const Image& image : images) {
                if (image.side() != side) continue;
                series.x.push_back(static_cast<double>(series.x.size() + 1));
                series.y.push_back((image.*pick).efficiency);
            }
            plot.series.push_back(series);
        }
    if (pes == paper::kPes && images.front().costs->label == "centre")
        plot.series.push_back({"paper, its worst image at 256 x 256",
                               {1, 1},
                               {paper::kEfficiency0, paper::kEfficiency16},
                               PlotStyle::kPaper});
    return plot;
}

// The paper says so in words, without figures; ours for them are named in the sentence.
std::string verdict_of(Range columns, Range cyclic) {
    constexpr double kHigh = 0.8, kStrongly = 2;
    const bool strongly = columns.width() >= kStrongly * cyclic.width() && columns.width() > 0;
    const bool high = cyclic.least >= kHigh;
    const std::string first = strongly ? "The column split varies strongly, as the paper says"
                                       : "The column split does not vary strongly, against what the paper says";
    const std::string second = high ? "the cyclic mapping is high for all, as the paper says"
                                    : "the cyclic mapping is not high for all, against what the paper says";
    return fmt::format("{} (\"strongly\": {:.1f} times the cyclic mapping's range or more); {} (\"high\": {} or more).",
                       first, kStrongly, second, kHigh);
}

std::string finding_of_worst(const std::vector<Image>& images) {
    const auto less = [](const Image& a, const Image& b) { return a.cyclic.efficiency < b.cyclic.efficiency; };
    const Image& worst = *std::min_element(images.begin(), images.end(), less);
    const auto lost = std::count_if(images.begin(), images.end(), [](const Image& image) {
        return image.columns.efficiency > image.cyclic.efficiency;
    });
    std::string text = fmt::format("The cyclic mapping's lowest is {}: {:.3f}, where the column split has {:.3f}. ",
                                   worst.name(), worst.cyclic.efficiency, worst.columns.efficiency);
    return text + (lost > 0
                       ? fmt::format("The column split is the better one for {} of {} images.", lost, images.size())
                       : fmt::format("It is never below the column split on {} images.", images.size()));
}

std::string finding_of_sides(const std::vector<Image>& images) {
    std::string text;
    for (const std::uint32_t side : sides_of(images))
        text += fmt::format("{}{} x {}: {:.3f} and {:.3f}",
                            text.empty() ? "Mean efficiency of p = 0 and of the cyclic mapping at " : ", at ", side,
                            side, mean_of(images, side, &Image::columns), mean_of(images, side, &Image::cyclic));
    return text + ".";
}

std::vector<Comparison> comparisons_of(const std::vector<Image>& images, std::uint32_t pes, Range columns,
                                       Range cyclic) {
    const Image& first = images.front();
    const bool same = pes == paper::kPes && first.costs->label == "centre" && first.side() == paper::kSize;
    const auto paper = [&](double value) { return same ? std::optional<double>(value) : std::nullopt; };
    return {{first.name() + ", p = 0", "", paper(paper::kEfficiency0), first.columns.efficiency,
             same ? "the paper's from its tables, of its most unbalanced image" : ""},
            {first.name() + ", cyclic", "", paper(paper::kEfficiency16), first.cyclic.efficiency,
             same ? "the paper's from its tables" : ""},
            {"lowest of all, p = 0", "", {}, columns.least, "the paper: varies strongly"},
            {"highest of all, p = 0", "", {}, columns.most, ""},
            {"lowest of all, cyclic", "", {}, cyclic.least, "the paper: high for all"},
            {"highest of all, cyclic", "", {}, cyclic.most, ""}};
}

}  // namespace

StudyPage images_page(std::uint32_t pes, const std::vector<const Costs*>& all) {
    const auto p = static_cast<std::uint32_t>(std::lround(std::sqrt(pes)));
    std::vector<Image> images;
    for (const Costs* costs : all) {
        const std::uint32_t side = costs->trace.width;
        const auto load = [&](std::uint32_t offset) {
            return static_load(costs->trace, make_mapping("cyclic", side, side, pes, offset, "cyclic"));
        };
        images.push_back({costs, load(0), load(p)});
    }
    const Range columns = range_of(images, &Image::columns), cyclic = range_of(images, &Image::cyclic);
    const auto [fewest, most] = std::minmax_element(
        all.begin(), all.end(), [](const Costs* a, const Costs* b) { return a->objects < b->objects; });
    StudyPage page;
    page.name = "images";
    page.title = "Ten scenes, two sizes: efficiency";
    page.question = "Is the cyclic mapping good for every image, or only for the one that the paper analyses?";
    page.method = {
        fmt::format("Each scene on {} PEs of the SPA, column split and p = sqrt(P) = {}; first pass.", pes, p),
        "Where the image is wider than the array, the fold is cyclic: PE i has the slots i, i + P, ...",
        fmt::format(
            "Efficiency = mean load / largest load, modelled computing alone. The paper had several images of 6 to 30 "
            "objects; its scenes are not known, these are ours, of {} to {}.",
            (*fewest)->objects, (*most)->objects)};
    page.settings = {{"pes", pes}, {"offset", p}, {"images", images.size()}};
    page.comparisons = comparisons_of(images, pes, columns, cyclic);
    page.tables = {table_of(images, p)};
    page.plots = {plot_of(images, pes, p)};
    page.findings = {
        fmt::format("Efficiency is {:.3f} to {:.3f} with the column split and {:.3f} to {:.3f} with p = {}.",
                    columns.least, columns.most, cyclic.least, cyclic.most, p),
        verdict_of(columns, cyclic), finding_of_worst(images), finding_of_sides(images)};
    return page;
}

StudyPage study_images(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const std::uint32_t size = lab.size(256);
    std::vector<const Costs*> images;
    for (const std::uint32_t side : {size, 2 * size})
        for (const LabelledScene& scene : scenes.empty() ? paper_like_scenes() : scenes)
            images.push_back(&lab.costs(scene, side));
    return images_page(size, images);
}

}  // namespace raya
