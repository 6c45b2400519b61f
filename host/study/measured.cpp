#include "host/study/measured.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <vector>

#include "host/ring/ring_renderer.hpp"
#include "host/study/arrays.hpp"
#include "tests/reference/reference.hpp"

namespace raya {
namespace {

constexpr int kReferenceRuns = 3, kDeviceRuns = 5;
constexpr double kEnoughS = 10;  // of measuring: a large scene is not rendered again

}  // namespace

Measured measured_of(std::vector<double> seconds) {
    std::sort(seconds.begin(), seconds.end());
    const std::size_t middle = seconds.size() / 2;
    const double median = seconds.size() % 2 == 1 ? seconds[middle] : (seconds[middle - 1] + seconds[middle]) / 2;
    return {1e3 * seconds.front(), 1e3 * median, 1e3 * seconds.back(), static_cast<int>(seconds.size())};
}

double sample_seconds(const std::function<double()>& seconds) {
    constexpr double kLeastSeconds = 0.02;
    double sum = 0;
    int calls = 0;
    while (sum < kLeastSeconds) {
        sum += seconds();
        ++calls;
    }
    return sum / calls;
}

Measured measure(int runs, double enough_s, const std::function<double()>& seconds) {
    std::vector<double> all = {seconds()};
    while (static_cast<int>(all.size()) < runs && std::accumulate(all.begin(), all.end(), 0.0) < enough_s)
        all.push_back(seconds());
    return measured_of(std::move(all));
}

Measured measure_warm(int runs, double enough_s, const std::function<double()>& seconds) {
    seconds();
    return measure(runs, enough_s, seconds);
}

Measured measure_reference(const LabelledScene& scene, std::uint32_t size) {
    using Clock = std::chrono::steady_clock;
    const reference::Options options{.width = static_cast<int>(size),
                                     .height = static_cast<int>(size),
                                     .bounces = static_cast<int>(machine_named("spa").bounces),
                                     .threads = 1};
    reference::render(scene.scene, {.width = 32, .height = 32, .bounces = options.bounces, .threads = 1});  // warms up
    return measure(kReferenceRuns, kEnoughS, [&] {
        const Clock::time_point start = Clock::now();
        reference::render(scene.scene, options);
        return std::chrono::duration<double>(Clock::now() - start).count();
    });
}

Measured measure_device(Session& session, const LabelledScene& scene, std::uint32_t size, const NumberFormat& format) {
    RingSettings settings;
    settings.machine = machine_named("grande");
    settings.format = format;
    settings.bounces = machine_named("spa").bounces;
    settings.mapping = cyclic(size, 16 % size);
    RingRenderer renderer(session, scene.scene, settings);
    return measure_warm(kDeviceRuns, kEnoughS, [&] { return trace_seconds(renderer.render()); });
}

}  // namespace raya
