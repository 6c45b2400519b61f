// Efficiency of the column split and of the cyclic mapping over ten scenes and two image sizes.
#include <cmath>

#include "host/ring/schedule.hpp"
#include "host/scene/generate.hpp"
#include "host/study/arrays.hpp"
#include "host/study/ensemble.hpp"
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

// Scenes are numbered in the order of their first image, and named below the axis; every series has a point for each.
StudyPlot plot_of(const Images& images, std::uint32_t pes, std::uint32_t p) {
    const auto first = where(images, [&](const Image& image) { return image.side == images.front().side; });
    std::string names = "scene: ";
    for (const Image& image : first) {
        constexpr std::size_t kInLine = 5;
        if (image.scene_number > 1) names += (image.scene_number - 1) % kInLine == 0 ? ",\n" : ", ";
        names += fmt::format("{} {}", image.scene_number, image.scene);
    }
    StudyPlot plot{"images", "Efficiency over the scenes", names, "efficiency"};
    for (const Efficiency efficiency : {&Image::cyclic_efficiency, &Image::columns_efficiency}) {
        const std::uint32_t offset = efficiency == &Image::columns_efficiency ? 0 : p;
        const auto label = [&](const Image& image) { return fmt::format("p = {} at {}", offset, image.size()); };
        for (PlotSeries& series : lines(images, label, &Image::scene_number, efficiency, PlotStyle::kPoints))
            plot.series.push_back(std::move(series));
    }
    if (pes == paper::kPes && images.front().scene == "centre")
        plot.series.push_back({"Kohata & Ito, their worst image",
                               {1, 1},
                               {paper::kEfficiency0, paper::kEfficiency16},
                               PlotStyle::kPaper});
    return plot;
}

// Pictures of one kind: the scenes' own, views of one scene, random scenes.
struct Group {
    std::string label;
    Images images;
    std::size_t size() const { return images.size(); }
    Estimate columns() const { return mean_of_each(images, &Image::columns_efficiency); }
    Estimate cyclic() const { return mean_of_each(images, &Image::cyclic_efficiency); }
    Range columns_range() const { return {images, &Image::columns_efficiency}; }
    Range cyclic_range() const { return {images, &Image::cyclic_efficiency}; }
};

// How far an efficiency lies from the mean of all.
std::vector<double> deviations(const Images& images, Efficiency efficiency) {
    const double mean = mean_of_each(images, efficiency).mean;
    return each(images, [&](const Image& image) { return std::abs((image.*efficiency)() - mean); });
}

// The paper says so in words, without figures; ours for them are named in the sentence.
Claim claim_of_columns(const Images& images) {
    constexpr double kStrongly = 2;
    const auto columns = deviations(images, &Image::columns_efficiency),
               cyclic = deviations(images, &Image::cyclic_efficiency);
    std::vector<double> beyond;
    for (std::size_t i = 0; i < images.size(); ++i) beyond.push_back(columns[i] - kStrongly * cyclic[i]);
    const Estimate difference = estimate_of(beyond);
    return {paper::kSpa, "section on the experiments", "The column split's efficiency varies strongly over the images.",
            verdict_of(difference.low() > 0, difference.high() <= 0),
            finding("images", "varies", "images"_a = images.size(), "columns"_a = estimate_of(columns).mean,
                    "cyclic"_a = estimate_of(cyclic).mean, "strongly"_a = kStrongly)};
}

Claim claim_of_cyclic(const Images& images) {
    constexpr double kHigh = 0.8;
    const Image& worst = least(images, &Image::cyclic_efficiency);
    const bool high = worst.cyclic.efficiency >= kHigh;
    return {paper::kSpa, "section on the experiments", "The cyclic mapping's efficiency is high for all images.",
            verdict_of(high, !high),
            finding("images", "high", "images"_a = images.size(), "least"_a = worst.cyclic.efficiency,
                    "scene"_a = worst.scene, "high"_a = kHigh,
                    "count"_a = std::ranges::count_if(
                        images, [](const Image& image) { return image.cyclic.efficiency >= kHigh; }))};
}

StudyTable table_of_groups(const std::vector<Group>& groups) {
    return table_of("images-groups", "Mean efficiencies, with intervals of 95 %", groups,
                    {{"pictures", &Group::label},
                     {"number", &Group::size},
                     {"p = 0", [](const Group& g) { return g.columns().mean; }},
                     {"p = 0, +-", [](const Group& g) { return g.columns().half_width; }},
                     {"p = 0, least", [](const Group& g) { return g.columns_range().least; }},
                     {"p = 0, largest", [](const Group& g) { return g.columns_range().most; }},
                     {"cyclic", [](const Group& g) { return g.cyclic().mean; }},
                     {"cyclic, +-", [](const Group& g) { return g.cyclic().half_width; }},
                     {"cyclic, least", [](const Group& g) { return g.cyclic_range().least; }},
                     {"cyclic, largest", [](const Group& g) { return g.cyclic_range().most; }}});
}

// Efficiencies in ascending order: how many pictures have so little or less.
PlotSeries sorted_line(const std::string& label, const Images& images, Efficiency efficiency) {
    auto values = each(images, efficiency);
    std::ranges::sort(values);
    PlotSeries series{label, {}, values, PlotStyle::kSteps};
    for (std::size_t i = 0; i < values.size(); ++i)
        series.x.push_back(100 * static_cast<double>(i + 1) / static_cast<double>(values.size()));
    return series;
}

StudyPlot plot_of_groups(const std::vector<Group>& groups) {
    StudyPlot plot{"images-groups", "How many pictures are so efficient", "share of the pictures, ascending (%)",
                   "efficiency"};
    for (const Group& group : groups) {
        plot.series.push_back(sorted_line("cyclic, " + group.label, group.images, &Image::cyclic_efficiency));
        plot.series.push_back(sorted_line("p = 0, " + group.label, group.images, &Image::columns_efficiency));
    }
    return plot;
}

std::string finding_of_groups(const std::vector<Group>& groups) {
    return "Mean efficiency of p = 0 and of the cyclic mapping: " +
           joined(groups, "; ",
                  [](const Group& group) {
                      return fmt::format("{} of {} {}",
                                         with_interval(group.columns()) + " and " + with_interval(group.cyclic()),
                                         group.size(), group.label);
                  }) +
           ".";
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

std::vector<Comparison> comparisons_of(const Images& images, std::uint32_t pes, Range columns, Range cyclic) {
    const Image& first = images.front();
    const bool same = pes == paper::kPes && first.scene == "centre" && first.side == paper::kSize;
    const auto paper = [&](double value) { return same ? std::optional<double>(value) : std::nullopt; };
    const std::string name = first.scene + " at " + first.size(), source = same ? "of their most unbalanced image" : "";
    return {{name + ", p = 0", "", paper(paper::kEfficiency0), first.columns.efficiency, source, Source::kDerived},
            {name + ", cyclic", "", paper(paper::kEfficiency16), first.cyclic.efficiency, source, Source::kDerived},
            {"lowest of all, p = 0", "", std::nullopt, columns.least, "Kohata & Ito: varies strongly"},
            {"highest of all, p = 0", "", std::nullopt, columns.most},
            {"lowest of all, cyclic", "", std::nullopt, cyclic.least, "Kohata & Ito: high for all"},
            {"highest of all, cyclic", "", std::nullopt, cyclic.most}};
}

}  // namespace

StudyPage images_page(std::uint32_t pes, const std::vector<const Costs*>& all, const std::vector<ImageGroup>& more) {
    const std::uint32_t p = root_offset(pes);
    const Images images = images_of(pes, p, all);
    std::vector<Group> groups;
    for (const std::uint32_t side : distinct(images, &Image::side))
        groups.push_back({fmt::format("scenes at {0} x {0}", side),
                          where(images, [&](const Image& image) { return image.side == side; })});
    Images every = images;
    for (const ImageGroup& group : more) {
        groups.push_back({group.label, images_of(pes, p, group.pictures)});
        every.insert(every.end(), groups.back().images.begin(), groups.back().images.end());
    }
    const Range columns(images, &Image::columns_efficiency), cyclic(images, &Image::cyclic_efficiency);
    const auto objects = each(images, &Image::objects);
    StudyPage page = page_about(
        "images", {{"pes", pes}, {"offset", p}, {"images", images.size()}, {"groups", each(more, &ImageGroup::label)}},
        {{"fewest", std::ranges::min(objects)},
         {"most", std::ranges::max(objects)},
         {"more", joined(more, " ", [](const ImageGroup& group) { return group.method; })}});
    page.comparisons = comparisons_of(images, pes, columns, cyclic);
    if (every.size() > 1) page.claims = {claim_of_columns(every), claim_of_cyclic(every)};
    page.findings = {finding_of_groups(groups),
                     fmt::format("Of the scenes' own pictures efficiency is {:.3f} to {:.3f} with the column split and "
                                 "{:.3f} to {:.3f} with p = {}.",
                                 columns.least, columns.most, cyclic.least, cyclic.most, p),
                     finding_of_worst(images)};
    page.tables = {table_of_groups(groups), table_of_images(images, p)};
    page.plots = {plot_of(images, pes, p), plot_of_groups(groups)};
    page.news = {sentence("images", "news")};
    return page;
}

namespace {

// Views of the scene on which columns do worst, and random scenes of as many objects as the paper's.
std::vector<ImageGroup> groups_of(Laboratory& lab, const Scenes& scenes, std::uint32_t size) {
    constexpr int kFewest = 6, kMost = 30;  // objects, as in the paper
    std::vector<ImageGroup> groups;
    for (const LabelledScene& scene : scenes.empty() ? Scenes{embedded_scene("centre")} : scenes) {
        const Ensemble ensemble = ensemble_of(lab, scene, size);
        groups.push_back({"views of " + scene.label,
                          fmt::format("{} views of {}, of the seeds 1..{}, as in Fig. 8.", ensemble.views.size(),
                                      scene.label, ensemble.views.size()),
                          ensemble.views});
    }
    if (!scenes.empty()) return groups;
    ImageGroup random{"random scenes",
                      fmt::format("{} random scenes of {} to {} spheres, `raya generate random`, of the "
                                  "seeds 1..{}.",
                                  kMostViews, kFewest, kMost, kMostViews),
                      {}};
    for (int i = 1; i <= static_cast<int>(kMostViews); ++i) {
        const int spheres = kFewest + (i - 1) % (kMost - kFewest + 1);
        random.pictures.push_back(&lab.costs(
            {fmt::format("random-{}, seed {}", spheres, i), generate_random(spheres, static_cast<std::uint64_t>(i))},
            size));
    }
    groups.push_back(std::move(random));
    return groups;
}

}  // namespace

StudyPage study_images(Laboratory& lab, const Scenes& scenes) {
    const std::uint32_t size = lab.size(256);
    std::vector<const Costs*> images;
    for (const std::uint32_t side : {size, 2 * size})
        for (const LabelledScene& scene : scenes.empty() ? paper_like_scenes() : scenes)
            images.push_back(&lab.costs(scene, side));
    return images_page(size, images, groups_of(lab, scenes, size));
}

}  // namespace raya
