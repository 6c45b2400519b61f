// A made-up page with something of everything, and a look into the files that come of it.
#pragma once
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "host/study/page.hpp"

namespace raya {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A PNG of one pixel, RGB (255, 0, 0).
inline const std::string kRedPixel(
    "\211\120\116\107\015\012\032\012\000\000\000\015\111\110\104\122\000\000\000\001\000\000"
    "\000\001\010\002\000\000\000\220\167\123\336\000\000\000\014\111\104\101\124\170\332\143"
    "\370\317\300\000\000\003\001\001\000\367\003\101\103\000\000\000\000\111\105\116\104\256"
    "\102\140\202",
    69);

inline StudyPage small_page() {
    StudyPage page;
    page.name = "small";
    page.title = "A small study";
    page.question = "Does it add up?";
    page.method = {"One image.", "Two mappings."};
    page.comparisons = {{"u(0)", "", 1.5, 1.575, "calibrated"},
                        {"image transfer", "ms", 140, 35, "", Source::kDerived, 5},
                        {"u(8)", "", {}, 0.1 + 0.2, "not printed"},
                        {"lost", "rays", 0, 2, ""}};
    page.clock = "modelled.";
    page.claims = {{"A & B 1993", "Fig. 1", "It adds up.", ClaimVerdict::kReproduced, "2 = 1 + 1."},
                   {"A & B 1993", "Fig. 2", "Always.", ClaimVerdict::kCannotTell, "Tried once."}};
    page.news = {"It also multiplies."};
    page.findings = {"It does.", "Nearly."};
    page.tables = {{"small", "All offsets", {{"p"}, {"u"}, {"which, if any"}}},
                   {"small-long", "All loads", {{"load", "cycles"}}, {{123456.75}, {-0.0}}, false}};
    page.tables[0].rows = {{0, 1.0 / 3, "a|b \"c\""}, {-7, kInfinite, "d,\ne"}};
    page.plots = {{"small-u", "u over p", "offset p (pixels)", "imbalance u", Axes::kLogY}};
    page.plots[0].series = {{"ours", {0, 1, 2}, {1.5, 0.5, kInfinite}, PlotStyle::kLine, {0.25, 0, 1}},
                            {"steps", {0, 1, 2}, {1, 2, 3}, PlotStyle::kSteps},
                            {"scenes", {1, 1}, {0.25, 4}, PlotStyle::kPoints},
                            {"paper", {0}, {1.58}, PlotStyle::kPaper}};
    page.settings = {{"pes", 256}, {"scene", "`a` <b>.nff"}};
    page.pictures = {{"small-dot", "A dot.", "one <red> pixel", kRedPixel}};
    page.beside = "A & B 1993";
    page.run = {"1.2.3", "raya study small -o DIR", "a device", "a platform", "4.5"};
    return page;
}

inline std::string contents_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace raya
