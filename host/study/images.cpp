// Efficiency of the column split and of the cyclic mapping over ten scenes and two image sizes.
#include <cmath>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

struct Image {
    std::size_t number, scene_number;  // among all, from 1; among those of its size
    std::string scene;
    std::size_t objects;
    std::uint32_t side;
    Load columns, cyclic;

    std::string size() const { return fmt::format("{} x {}", side, side); }
    double columns_efficiency() const { return columns.efficiency; }
    double cyclic_efficiency() const { return cyclic.efficiency; }
};
using Images = std::vector<Image>;
using Efficiency = double (Image::*)() const;

Images images_of(std::uint32_t pes, std::uint32_t offset, const std::vector<const Costs*>& all) {
    Images images;
    for (const Costs* costs : all) {
        const std::uint32_t side = costs->trace.width;
        const auto load = [&](std::uint32_t p) { return static_load(costs->trace, cyclic(side, side, pes, p)); };
        const auto before = std::ranges::count(images, side, &Image::side);
        images.push_back({images.size() + 1, static_cast<std::size_t>(before) + 1, costs->label, costs->objects, side,
                          load(0), load(offset)});
    }
    return images;
}

struct Range {
    double least, most;
    Range(const Images& images, Efficiency efficiency)
        : least(std::ranges::min(each(images, efficiency))), most(std::ranges::max(each(images, efficiency))) {}
    double width() const { return most - least; }
};

StudyTable table_of_images(const Images& images, std::uint32_t p) {
    const std::string cyclic = fmt::format(", p = {}", p);
    return table_of("images", "Imbalance and efficiency of each image", images,
                    {{"no.", &Image::number},
                     {"scene", &Image::scene},
                     {"objects", &Image::objects},
                     {"side", &Image::side, "pixels"},
                     {"u, p = 0", [](const Image& image) { return image.columns.imbalance; }},
                     {"efficiency, p = 0", &Image::columns_efficiency},
                     {"u" + cyclic, [](const Image& image) { return image.cyclic.imbalance; }},
                     {"efficiency" + cyclic, &Image::cyclic_efficiency}});
}

// Scenes are numbered by their first image; every series has a point for each.
StudyPlot plot_of(const Images& images, std::uint32_t pes, std::uint32_t p) {
    StudyPlot plot{"images", "Efficiency over the scenes", "scene, by its first number in the table", "efficiency"};
    for (const Efficiency efficiency : {&Image::cyclic_efficiency, &Image::columns_efficiency}) {
        const std::uint32_t offset = efficiency == &Image::columns_efficiency ? 0 : p;
        const auto label = [&](const Image& image) { return fmt::format("p = {} at {}", offset, image.size()); };
        for (PlotSeries& series : lines(images, label, &Image::scene_number, efficiency, PlotStyle::kPoints))
            plot.series.push_back(std::move(series));
    }
    if (pes == paper::kPes && images.front().scene == "centre")
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
    return fmt::format(
        "The column split {} (\"strongly\": {:.1f} times the cyclic mapping's range or more); the cyclic mapping {} "
        "(\"high\": {} or more).",
        strongly ? "varies strongly, as the paper says" : "does not vary strongly, against what the paper says",
        kStrongly, high ? "is high for all, as the paper says" : "is not high for all, against what the paper says",
        kHigh);
}

std::string finding_of_worst(const Images& images) {
    const Image& worst = least(images, &Image::cyclic_efficiency);
    const auto lost = std::ranges::count_if(
        images, [](const Image& image) { return image.columns.efficiency > image.cyclic.efficiency; });
    return fmt::format("The cyclic mapping's lowest is {} at {}: {:.3f}, where the column split has {:.3f}. ",
                       worst.scene, worst.size(), worst.cyclic.efficiency, worst.columns.efficiency) +
           (lost > 0 ? fmt::format("The column split is the better one for {} of {} images.", lost, images.size())
                     : fmt::format("It is never below the column split on {} images.", images.size()));
}

double mean_of(const Images& images, Efficiency efficiency) {
    double sum = 0;
    for (const Image& image : images) sum += (image.*efficiency)();
    return sum / static_cast<double>(images.size());
}

std::string finding_of_sides(const Images& images) {
    return "Mean efficiency of p = 0 and of the cyclic mapping at " +
           joined(distinct(images, &Image::side), ", at ",
                  [&](std::uint32_t side) {
                      const Images some = where(images, [&](const Image& image) { return image.side == side; });
                      return fmt::format("{}: {:.3f} and {:.3f}", some[0].size(),
                                         mean_of(some, &Image::columns_efficiency),
                                         mean_of(some, &Image::cyclic_efficiency));
                  }) +
           ".";
}

std::vector<Comparison> comparisons_of(const Images& images, std::uint32_t pes, Range columns, Range cyclic) {
    const Image& first = images.front();
    const bool same = pes == paper::kPes && first.scene == "centre" && first.side == paper::kSize;
    const auto paper = [&](double value) { return same ? std::optional<double>(value) : std::nullopt; };
    const std::string name = first.scene + " at " + first.size(), source = same ? "the paper's from its tables" : "";
    return {{name + ", p = 0", "", paper(paper::kEfficiency0), first.columns.efficiency,
             source + (same ? ", of its most unbalanced image" : "")},
            {name + ", cyclic", "", paper(paper::kEfficiency16), first.cyclic.efficiency, source},
            {"lowest of all, p = 0", "", std::nullopt, columns.least, "the paper: varies strongly"},
            {"highest of all, p = 0", "", std::nullopt, columns.most},
            {"lowest of all, cyclic", "", std::nullopt, cyclic.least, "the paper: high for all"},
            {"highest of all, cyclic", "", std::nullopt, cyclic.most}};
}

}  // namespace

StudyPage images_page(std::uint32_t pes, const std::vector<const Costs*>& all) {
    const std::uint32_t p = root_offset(pes);
    const Images images = images_of(pes, p, all);
    const Range columns(images, &Image::columns_efficiency), cyclic(images, &Image::cyclic_efficiency);
    const auto objects = each(images, &Image::objects);
    StudyPage page = page_about("images", {{"pes", pes}, {"offset", p}, {"images", images.size()}},
                                {{"fewest", std::ranges::min(objects)}, {"most", std::ranges::max(objects)}});
    page.comparisons = comparisons_of(images, pes, columns, cyclic);
    page.findings = {
        fmt::format("Efficiency is {:.3f} to {:.3f} with the column split and {:.3f} to {:.3f} with p = {}.",
                    columns.least, columns.most, cyclic.least, cyclic.most, p),
        verdict_of(columns, cyclic), finding_of_worst(images), finding_of_sides(images)};
    page.tables = {table_of_images(images, p)};
    page.plots = {plot_of(images, pes, p)};
    return page;
}

StudyPage study_images(Laboratory& lab, const Scenes& scenes) {
    const std::uint32_t size = lab.size(256);
    std::vector<const Costs*> images;
    for (const std::uint32_t side : {size, 2 * size})
        for (const LabelledScene& scene : scenes.empty() ? paper_like_scenes() : scenes)
            images.push_back(&lab.costs(scene, side));
    return images_page(size, images);
}

}  // namespace raya
