// The rows of the study of accelerators: means of scenes that differ in their seed, what one way takes over another,
// and how that grows with the objects.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/study/accel_run.hpp"
#include "host/study/rows.hpp"
#include "host/study/statistics.hpp"

namespace raya::accel {

/// Kinds of scenes; those that were named are of no kind that grows.
inline constexpr const char *kBalls = "balls", *kRandom = "random", *kNamed = "named";
inline constexpr std::uint64_t kFittedFrom = 100;  // objects: below, what every render takes counts as much as they do
inline constexpr double kSameWork = 1e-3;          // of the rays

using Runs = std::vector<AccelRun>;

/// The runs of one group in one way, and what their mean is.
struct Row {
    Runs runs;  // one at least

    const AccelRun& first() const { return runs.front(); }
    const std::string& series() const { return first().series; }
    const std::string& group() const { return first().group; }
    const std::string& way() const { return first().way; }
    std::string line() const { return series() + ", " + way(); }
    bool is_counted() const { return first().is_counted(); }
    std::uint64_t objects() const { return first().objects; }
    std::size_t scenes() const { return runs.size(); }
    template <class Figure>
    Estimate of(Figure figure) const {
        return estimate_of(each(runs, [&](const AccelRun& run) { return double(std::invoke(figure, run)); }));
    }
    Estimate tests() const { return of(&AccelRun::tests_a_ray); }
    Estimate steps() const { return of(&AccelRun::steps_a_ray); }
    Estimate best_ms() const {
        return of([](const AccelRun& run) { return run.time.min_ms; });
    }
    double mean_tests() const { return tests().mean; }
    double mean_ms() const { return best_ms().mean; }
    double median_ms() const {
        return of([](const AccelRun& run) { return run.time.median_ms; }).mean;
    }
    double ns_a_ray() const { return of(&AccelRun::ns_a_ray).mean; }
    double build_ms() const { return of(&AccelRun::build_ms).mean; }
    double scene_bytes() const { return 4 * of(&AccelRun::scene_words).mean; }
    double accel_bytes() const { return 4 * of(&AccelRun::accel_words).mean; }
    double pe_kb() const { return (scene_bytes() + accel_bytes()) / 1024; }
};
using Rows = std::vector<Row>;

Rows rows_of(const Runs& runs);
Rows of_series(const Rows& rows, const std::string& series);
Rows of_way(const Rows& rows, const std::string& way);

/// Whether both trace the same rays, but for one in a thousand.
bool same_rays(const AccelRun& a, const AccelRun& b);

/// The time of one way over that of another: mean of the scenes of a group that have both, or of a single scene's
/// turns.
struct Ratio {
    std::string group;
    std::uint64_t objects = 0;
    Estimate times;

    bool is_faster() const { return times.low() > 1; }   // the other is
    bool is_slower() const { return times.high() < 1; }  // the other is
};
using Ratios = std::vector<Ratio>;

/// Of every group that has scenes in both ways with the same rays.
Ratios ratios(const Rows& rows, const std::string& way, const std::string& other);

/// How what a ray takes grows, in one way of a series.
struct Growth {
    std::string series, way;
    std::uint64_t from = 0, to = 0;  // objects
    Estimate time, tests;            // exponents
    bool is_counted = true;
};

/// Of every series and way that has two numbers of objects from kFittedFrom on.
std::vector<Growth> growth_of(const Rows& rows);

}  // namespace raya::accel
