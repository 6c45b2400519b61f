#include "host/study/accel_rows.hpp"

#include <algorithm>
#include <cmath>

namespace raya::accel {

Rows rows_of(const Runs& runs) {
    Rows rows;
    for (const AccelRun& run : runs) {
        const auto same = [&](const Row& row) {
            return row.series() == run.series && row.group() == run.group && row.way() == run.way;
        };
        const auto found = std::ranges::find_if(rows, same);
        if (found == rows.end())
            rows.push_back({{run}});
        else
            found->runs.push_back(run);
    }
    return rows;
}

Rows of_series(const Rows& rows, const std::string& series) {
    return where(rows, [&](const Row& row) { return row.series() == series; });
}

Rows of_way(const Rows& rows, const std::string& way) {
    return where(rows, [&](const Row& row) { return row.way() == way; });
}

bool same_rays(const AccelRun& a, const AccelRun& b) {
    const auto x = static_cast<double>(a.rays), y = static_cast<double>(b.rays);
    return std::abs(x - y) <= kSameWork * std::min(x, y);
}

namespace {

// Turn by turn: what disturbs a turn disturbs both.
std::vector<double> turn_ratios(const AccelRun& run, const AccelRun& beside) {
    std::vector<double> times;
    for (std::size_t i = 0; i < std::min(run.turns_ms.size(), beside.turns_ms.size()); ++i)
        times.push_back(run.turns_ms[i] / beside.turns_ms[i]);
    return times;
}

// Nothing where no scene has both with the same rays.
Estimate ratio_of(const Runs& some, const Runs& others) {
    std::vector<double> times, turns;
    for (const AccelRun& run : some)
        for (const AccelRun& beside : others)
            if (run.seed == beside.seed && same_rays(run, beside)) {
                times.push_back(run.time.min_ms / beside.time.min_ms);
                turns = turn_ratios(run, beside);
            }
    if (times.empty()) return {};
    return estimate_of(some.size() == 1 && !turns.empty() ? turns : times);
}

}  // namespace

Ratios ratios(const Rows& rows, const std::string& way, const std::string& other) {
    Ratios all;
    for (const Row& a : of_way(rows, way))
        for (const Row& b : of_way(rows, other))
            if (a.series() == b.series() && a.group() == b.group())
                all.push_back({a.group(), a.objects(), ratio_of(a.runs, b.runs)});
    return where(all, [](const Ratio& one) { return one.times.count > 0; });
}

std::vector<Growth> growth_of(const Rows& rows) {
    std::vector<Growth> all;
    for (const std::string& series : distinct(rows, &Row::series))
        for (const std::string& way : distinct(of_series(rows, series), &Row::way)) {
            Runs runs;
            for (const Row& row : of_way(of_series(rows, series), way))
                if (row.objects() >= kFittedFrom) runs.insert(runs.end(), row.runs.begin(), row.runs.end());
            if (series == kNamed || distinct(runs, &AccelRun::objects).size() < 2) continue;
            std::vector<double> time, tests;
            for (const std::uint64_t seed : distinct(runs, &AccelRun::seed)) {
                const Runs line = where(runs, [&](const AccelRun& run) { return run.seed == seed; });
                const auto objects = each(line, [](const AccelRun& run) { return double(run.objects); });
                time.push_back(fitted_exponent(objects, each(line, &AccelRun::ns_a_ray)));
                if (line.front().is_counted())
                    tests.push_back(fitted_exponent(objects, each(line, &AccelRun::tests_a_ray)));
            }
            const auto [least, most] = std::ranges::minmax(each(runs, &AccelRun::objects));
            const bool counted = !tests.empty();
            all.push_back(
                {series, way, least, most, estimate_of(time), counted ? estimate_of(tests) : Estimate{}, counted});
        }
    return all;
}

}  // namespace raya::accel
