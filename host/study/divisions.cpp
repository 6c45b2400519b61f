// Fig. 3 of Yoshitani & Yamazaki: divisions of space, by one machine.
#include <cctype>
#include <stdexcept>

#include "host/scene/generate.hpp"
#include "host/study/grid_run.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kMostPower = 13;  // 8192 divisions

// What is looked at: a figure of each render, its plot, and what its least is called.
struct Subject {
    const char *plot, *title, *y_label, *optimum;
    double (*figure)(const GridRun&);
};
constexpr Subject kSubjects[] = {
    {"divisions-modelled", "Modelled time against divisions", "modelled time of a T805 (s)", "least modelled time",
     [](const GridRun& run) { return run.modelled_s(); }},
    {"divisions-tests", "Intersection tests against divisions", "intersection tests", "fewest tests",
     [](const GridRun& run) { return run.tests(); }},
    {"divisions-measured", "Measured time against divisions", "measured time (ms)", "least measured time",
     [](const GridRun& run) { return run.measured_ms; }}};
constexpr const Subject &kModelled = kSubjects[0], &kTests = kSubjects[1], &kMeasured = kSubjects[2];

using Series = std::vector<GridRun>;

Series flat(const std::vector<Series>& all) {
    Series runs;
    for (const Series& series : all) runs.insert(runs.end(), series.begin(), series.end());
    return runs;
}

const GridRun* with_voxels(const Series& series, std::uint64_t voxels) {
    const auto found = std::ranges::find(series, voxels, &GridRun::voxels);
    return found == series.end() ? nullptr : &*found;
}

// Over the least of the series.
double over_least(const Series& series, const GridRun& run, const Subject& subject) {
    return subject.figure(run) / subject.figure(least(series, subject.figure));
}

std::vector<StudyPlot> plots_of(const std::vector<Series>& all) {
    std::vector<StudyPlot> plots;
    for (const Subject& s : kSubjects)
        plots.push_back({s.plot, s.title, "divisions", s.y_label, Axes::kLogBoth,
                         lines(flat(all), &GridRun::label, &GridRun::voxels, s.figure)});
    return plots;
}

StudyTable table_of_runs(const std::vector<Series>& all) {
    const auto a_ray = [](double count, const GridRun& run) { return count * (1 / static_cast<double>(run.rays())); };
    return table_of(
        "divisions", "Each number of objects and divisions", flat(all),
        {{"scene", &GridRun::label},
         {"divisions", &GridRun::voxels},
         {"A x B x C", &GridRun::sides},
         {"copies", &GridRun::copies},
         {"rays", &GridRun::rays},
         {"tests", [](const GridRun& run) { return test_count(run.events); }},
         {"steps", [](const GridRun& run) { return run.events[RAYA_STEPS]; }},
         {"tests a ray", [=](const GridRun& run) { return a_ray(run.tests(), run); }},
         {"steps a ray", [=](const GridRun& run) { return a_ray(static_cast<double>(run.events[RAYA_STEPS]), run); }},
         {"modelled", &GridRun::modelled_s, "s"},
         {"measured", &GridRun::measured_ms, "ms"},
         {"measured, median", &GridRun::median_ms, "ms"}});
}

// The figure at 32 divisions over that at 1024.
double fall_of(const Series& series, const Subject& subject) {
    const GridRun *few = with_voxels(series, paper::kFewDivisions), *many = with_voxels(series, paper::kManyDivisions);
    if (few == nullptr || many == nullptr) throw std::logic_error("the paper's divisions are not among the runs");
    return subject.figure(*few) / subject.figure(*many);
}

std::vector<Comparison> comparisons_of(const std::vector<Series>& all, bool from_paper) {
    std::vector<Comparison> comparisons;
    if (from_paper) {
        const Series& most = all.back();
        const std::string what = "32 over 1024 divisions, 1024 objects: ";
        comparisons = {
            {what + "modelled time", "", paper::kDivisionsFall, fall_of(most, kModelled), "a T805's", Source::kDerived},
            {what + "measured time", "", paper::kDivisionsFall, fall_of(most, kMeasured), "this device's",
             Source::kDerived},
            {what + "tests", "", paper::kTestsFall, fall_of(most, kTests), "Yoshitani & Yamazaki: \"about 1/5\""}};
    }
    for (const Subject& subject : kSubjects)
        for (const Series& series : all) {
            const GridRun& best = least(series, subject.figure);
            const bool predicted = from_paper && &subject != &kMeasured;
            comparisons.push_back({fmt::format("{}, {}", subject.optimum, best.label), "divisions",
                                   predicted ? std::optional(double(best.objects)) : std::nullopt,
                                   double(best.voxels()), best.sides()});
        }
    return comparisons;
}

std::string finding_of_fall(const Series& most) {
    return fmt::format(
        "1024 objects at 32 divisions, beside 1024: the time of Yoshitani & Yamazaki is {:.1f} times as long, ours "
        "{:.1f} times modelled and {:.1f} times measured; the tests are {:.1f} times as many, beside their \"about "
        "1/5\".",
        paper::kDivisionsFall, fall_of(most, kModelled), fall_of(most, kMeasured), fall_of(most, kTests));
}

// Where the optima lie as multiples of the objects, in words.
std::string finding_of_optimum(const Subject& subject, const std::vector<Series>& all) {
    const auto best = [&](const Series& series) -> const GridRun& { return least(series, subject.figure); };
    const auto equal = std::ranges::count_if(all, [&](const Series& s) { return best(s).voxels() == best(s).objects; });
    const auto last = std::ranges::count_if(all, [&](const Series& s) { return &best(s) == &s.back(); });
    std::string text = fmt::format(
        "{}: at divisions {}; divisions = objects is it for {} of {}{}.", subject.optimum,
        joined(all, ", ", [&](const Series& s) { return fmt::format("{} for {}", best(s).voxels(), best(s).label); }),
        equal, all.size(), last > 0 ? fmt::format("; {} at the last division tried, so it may lie beyond", last) : "");
    text[0] = static_cast<char>(std::toupper(text[0]));
    return text;
}

// What is lost by divisions = objects, where it was tried, and how far the objects then are from one voxel each.
std::string finding_of_loss(const std::vector<Series>& all) {
    const auto equal = [](const Series& series) { return with_voxels(series, series.front().objects); };
    const auto tried = where(all, [&](const Series& series) { return equal(series) != nullptr; });
    if (tried.empty()) return "No scene here was cut into as many voxels as it has objects.";
    return fmt::format(
        "Divisions = objects takes {} times the least modelled time and {} times the fewest tests; an object then lies "
        "in {} voxels.",
        joined(tried, ", ",
               [&](const Series& s) {
                   return fmt::format("{:.2f} ({})", over_least(s, *equal(s), kModelled), s.front().label);
               }),
        joined(tried, ", ", [&](const Series& s) { return fmt::format("{:.2f}", over_least(s, *equal(s), kTests)); }),
        joined(tried, ", ", [&](const Series& s) { return fmt::format("{:.2f}", equal(s)->voxels_of_object()); }));
}

// How far times rise again behind their least.
std::string finding_of_rise(const std::vector<Series>& all) {
    return fmt::format("At {} divisions the modelled time is {} times the least.", all.front().back().voxels(),
                       joined(all, ", ", [](const Series& s) {
                           return fmt::format("{:.2f} ({})", over_least(s, s.back(), kModelled), s.front().label);
                       }));
}

// Percent of the modelled time that the events take.
std::string share_of(const GridRun& run, std::initializer_list<std::size_t> events) {
    EventCounts part{};
    for (const std::size_t event : events) part[event] = run.events[event];
    return fmt::format("{:.0f}", 100 * t805_ms(part) / t805_ms(run.events));
}

// Fewer tests come with more steps, and what rays and hits take stays.
std::string finding_of_parts(const Series& series) {
    const auto at = where(std::vector{with_voxels(series, paper::kFewDivisions),
                                      with_voxels(series, paper::kManyDivisions), &series.back()},
                          [](const GridRun* run) { return run != nullptr; });
    return fmt::format(
        "{}: at {} divisions, tests take {} % of the modelled time, walking from voxel to voxel {} %; an object lies "
        "in {:.1f} voxels at the last.",
        series.front().label, joined(at, ", ", &GridRun::voxels),
        joined(at, ", ",
               [](const GridRun* run) {
                   return share_of(*run, {RAYA_SPHERE_TESTS, RAYA_PLANE_TESTS, RAYA_POLYGON_TESTS, RAYA_CONE_TESTS});
               }),
        joined(at, ", ",
               [](const GridRun* run) {
                   return share_of(*run, {RAYA_WALKS, RAYA_STEPS});
               }),
        series.back().voxels_of_object());
}

// Claims of Yoshitani & Yamazaki.

Claim claim(const char* place, const char* words, bool seen, std::string why) {
    return {paper::kTp, place, words, seen ? ClaimVerdict::kReproduced : ClaimVerdict::kNotReproduced, std::move(why)};
}

constexpr double kNoticed = 1.02;  // times as much: not the same

bool rises(const std::vector<Series>& all) {
    return std::ranges::all_of(all, [](const Series& s) { return over_least(s, s.back(), kModelled) > kNoticed; });
}

// Of all series the least lies where there are as many divisions as objects, or is no more than 2 % less.
bool is_least_at_objects(const std::vector<Series>& all, const Subject& subject) {
    return std::ranges::all_of(all, [&](const Series& series) {
        const GridRun* equal = with_voxels(series, series.front().objects);
        return equal != nullptr && over_least(series, *equal, subject) <= kNoticed;
    });
}

std::string why_of_optimum(const Subject& subject, const std::vector<Series>& all) {
    return fmt::format("{} {} Within 2 % it would count as the least.", finding_of_optimum(subject, all),
                       finding_of_loss(all));
}

double fall_from_one(const Series& series) { return over_least(series, series.front(), kModelled); }

std::vector<Claim> claims_of(const std::vector<Series>& all) {
    constexpr double kNear = 1.25, kFewestFifth = 4, kMostFifth = 6;  // what counts as the same time, as "about 1/5"
    const double modelled = fall_of(all.back(), kModelled), measured = fall_of(all.back(), kMeasured),
                 tests = fall_of(all.back(), kTests);
    const auto is_near = [](double fall) {
        return std::max(fall / paper::kDivisionsFall, paper::kDivisionsFall / fall) <= kNear;
    };
    Claim times = claim("Fig. 3", "1024 objects take 313 s with 32 divisions and 60 s with 1024, 5.2 times less.",
                        is_near(modelled) && is_near(measured),
                        fmt::format("{:.2f} times less modelled, {:.2f} measured; a quarter more or less would do.",
                                    modelled, measured));
    if (is_near(modelled) != is_near(measured)) times.verdict = ClaimVerdict::kCannotTell;
    return {claim("Fig. 3", "Time falls until there are as many divisions as objects, then it rises.",
                  is_least_at_objects(all, kModelled) && rises(all),
                  why_of_optimum(kModelled, all) + ' ' + finding_of_rise(all)),
            claim("Fig. 3", "It falls the more, the more objects there are.",
                  std::ranges::is_sorted(all, {}, fall_from_one),
                  fmt::format("From one division to the least modelled time: {} times less.",
                              joined(all, ", ",
                                     [](const Series& s) {
                                         return fmt::format("{:.1f} ({})", fall_from_one(s), s.front().label);
                                     }))),
            times,
            claim("Fig. 3", "The tests fall to about 1/5 from 32 to 1024 divisions, 1024 objects.",
                  tests >= kFewestFifth && tests <= kMostFifth,
                  fmt::format("They fall to 1 / {:.1f}; 1/4 to 1/6 would do.", tests)),
            claim("conclusion", "The tests are fewest where there are as many divisions as objects.",
                  is_least_at_objects(all, kTests), why_of_optimum(kTests, all))};
}

Scenes even_scenes() {
    Scenes scenes;
    for (const std::uint32_t k : {6, 8, 9, 10}) {
        const Divisions d = near_cube(1u << k);
        scenes.push_back(
            {fmt::format("{} objects", 1u << k), generate_uniform(1 << k, {int(d[0]), int(d[1]), int(d[2])})});
    }
    return scenes;
}

}  // namespace

StudyPage divisions_page(std::uint32_t side, const std::vector<std::vector<GridRun>>& all, bool from_paper) {
    Json settings = {{"size", side}, {"bounces", 0}, {"format", "fp32"}};
    for (const Series& series : all)
        settings["scenes"].push_back({{"scene", series.front().label}, {"objects", series.front().objects}});
    StudyPage page = page_about(
        "divisions", settings,
        {{"scenes",
          from_paper
              ? "64 to 1024 matt spheres, one in each of as many voxels of a cube. Our grid cuts the box of the "
                "spheres, which is a little smaller than that cube: some spheres lie across its planes."
              : "The scenes that were named. A x B x C as near to a cube as powers of two allow, whatever the box."}});
    page.comparisons = comparisons_of(all, from_paper);
    page.clock = sentence("divisions", "clock");
    page.news = {sentence("divisions", "news")};
    if (from_paper) {
        page.claims = claims_of(all);
        page.findings.push_back(finding_of_fall(all.back()));
    }
    for (const Subject& subject : kSubjects) page.findings.push_back(finding_of_optimum(subject, all));
    page.findings.insert(page.findings.end(),
                         {finding_of_loss(all), finding_of_rise(all), finding_of_parts(all.back())});
    page.tables = {table_of_runs(all)};
    page.plots = plots_of(all);
    return page;
}

StudyPage study_divisions(Laboratory& lab, const Scenes& scenes) {
    const std::uint32_t side = lab.size(96);
    std::vector<Series> all;
    for (const LabelledScene& scene : scenes.empty() ? even_scenes() : scenes) {
        all.emplace_back();
        for (std::uint32_t k = 0; k <= kMostPower; ++k)
            all.back().push_back(run_grid(lab.session(), scene, near_cube(1u << k), {.side = side, .runs = 5}));
    }
    return divisions_page(side, all, scenes.empty());
}

}  // namespace raya
