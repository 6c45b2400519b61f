#include "host/tune/tune.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>

#include "host/base/child_process.hpp"
#include "host/base/log.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"
#include "host/mesh/mesh_file.hpp"
#include "host/report/render_report.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/tune/bench_rows.hpp"
#include "host/tune/store.hpp"

namespace raya {
namespace {

using Values = std::vector<std::uint32_t>;

constexpr std::pair<const char*, std::uint32_t TunedValues::*> kParameters[] = {
    {"lanes", &TunedValues::lanes},
    {"group", &TunedValues::group},
    {"local words", &TunedValues::local_words},
    {"batch", &TunedValues::batch}};

// Returns the powers of two in minimum..maximum, and `default_size`.
Values group_sizes(std::uint32_t minimum, std::uint32_t maximum, std::uint32_t default_size) {
    std::set<std::uint32_t> sizes = {default_size};
    for (std::uint32_t size = minimum; size <= maximum; size *= 2) sizes.insert(size);
    return {sizes.begin(), sizes.end()};
}

constexpr double kMaxWinRatio = 0.98;
constexpr std::uint32_t kSamples = 5, kFinalSamples = 9;  // samples per candidate: search; final comparison
// Time limits in seconds, builds included: of a candidate; of the first trial of the defaults and the final comparison.
constexpr double kCandidate_s = 20, kComparison_s = 200;

double min_of(const std::vector<double>& seconds) { return *std::ranges::min_element(seconds); }

// Returns the median of the ratios of the samples of two candidates.
double median_ratio(const std::vector<double>& seconds, const std::vector<double>& reference) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(seconds.size(), reference.size()); ++i)
        ratios.push_back(seconds[i] / reference[i]);
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::ranges::nth_element(ratios, middle);
    return *middle;
}

Json request_json(const Workload& workload, const TrialSetup& render, const std::vector<TunedValues>& candidates,
                  std::uint32_t samples) {
    Json values = Json::array();
    for (const TunedValues& candidate : candidates) values.push_back(to_json(candidate));
    return {{"device", render.device},
            {"scene", render.scene},
            {"kernel_dir", render.kernel_dir},
            {"strict", render.strict},
            {"size", std::array{render.size.width, render.size.height}},
            {"pes", render.pes},
            {"variant", workload.variant},
            {"format", format_name(workload.format)},
            {"candidates", values},
            {"samples", samples}};
}

// Runs a trial in a child process, because drivers may crash or hang. Ends it after `limit_s` seconds.
Trial run_trial(const Json& request, const std::vector<TunedValues>& candidates, const std::string& expected_check,
                double limit_s, const TrialProgress& progress) {
    const Clock::time_point start = Clock::now();
    Trial trial{.values = candidates.back(), .error = {}, .check = {}, .samples = {}};
    std::size_t built = 0;  // number of candidates whose kernels are built
    const auto fail = [&](const std::string& why) {
        trial.error = (built < candidates.size() ? "compile: " : "runtime: ") + why.substr(0, why.find('\n'));
    };
    const auto take = [&](const Json& line) {
        if (line.is_null()) progress(trial.values, seconds_since(start));
        if (line.contains("built")) built = line["built"];
        if (line.contains("check")) trial.check = line["check"];
        if (line.contains("samples")) trial.samples = line["samples"];
        if (seconds_since(start) > limit_s)
            trial.error = fmt::format("timeout: not done in {:.0f} s", limit_s);
        else if (line.contains("check") && !expected_check.empty() && trial.check != expected_check)
            trial.error = fmt::format("correctness: image is {}; expected {}", trial.check, expected_check);
        return trial.error.empty() && trial.samples.empty();
    };
    try {
        if (const auto status = run_child(kTrialTask, request, take)) fail("ended by " + ending_text(*status));
    } catch (const UserError&) {
        throw;
    } catch (const std::runtime_error& error) {
        fail(error.what());
    }
    return trial;
}

}  // namespace

Space space_of(const DeviceInfo& device, const TuningKey& key) {
    const bool cpu = device.type == "cpu", tests_all_objects = key.accel == RAYA_ACCEL_NONE;
    const TunedValues defaults = default_values(device, key);
    const std::uint32_t max_group = max_group_size_of(device);
    // Only llvmpipe ends loops early. It vectorises over work-items, so one lane suffices, and it needs minutes and
    // gigabytes of memory to compile kernels with several lanes.
    const bool llvmpipe = device.ends_loops_early;
    const Values lanes = llvmpipe ? Values{1} : Values{1, 4, 8, 16};
    // Torus nodes on a CPU keep their default group size, which preserves the order of packets (docs/architecture.md).
    const std::uint32_t max_cpu_group = key.torus ? defaults.group : std::min(llvmpipe ? 16u : 4u, max_group);
    const Values groups =
        cpu ? group_sizes(1, max_cpu_group, defaults.group) : group_sizes(16, max_group, defaults.group);
    const Values local_words = tests_all_objects ? Values{0, 1} : Values{defaults.local_words};
    Values batches = {defaults.batch};
    if (tests_all_objects && key.fp32 && !key.torus) batches = cpu ? Values{0, 8, 16} : Values{0, 4, 8, 16, 32};
    Space space{defaults};
    for (const std::uint32_t l : lanes)
        for (const std::uint32_t g : groups)
            for (const std::uint32_t w : local_words)
                for (const std::uint32_t b : batches) space.candidates.push_back({l, g, w, b});
    std::ranges::stable_sort(space.candidates, {}, [&](const TunedValues& values) {
        return std::ranges::count_if(
            kParameters, [&](const auto& parameter) { return values.*parameter.second != defaults.*parameter.second; });
    });
    return space;
}

std::string change_text(const TunedValues& old_values, const TunedValues& new_values) {
    std::vector<std::string> texts;
    for (const auto& [name, member] : kParameters) {
        const auto text = [&, is_flag = member == &TunedValues::local_words](std::uint32_t value) {
            return is_flag ? (value ? "yes" : "no") : value ? std::to_string(value) : "default";
        };
        texts.push_back(fmt::format("{} {}", name, text(old_values.*member)));
        if (old_values.*member != new_values.*member) texts.back() += " -> " + text(new_values.*member);
    }
    return fmt::format("{}", fmt::join(texts, ", "));
}

double ratio_of(const Trial& trial) {
    if (trial.samples.empty()) return 1;
    const std::vector<double>&last = trial.samples.back(), &first = trial.samples.front();
    return std::max(min_of(last) / min_of(first), median_ratio(last, first));
}

bool wins_significantly(const Trial& trial) {
    if (!trial.error.empty() || ratio_of(trial) > kMaxWinRatio) return false;
    const std::vector<double>&last = trial.samples.back(), &first = trial.samples.front();
    std::size_t lost_pairs = 0;
    for (std::size_t i = 0; i < last.size(); ++i) lost_pairs += last[i] >= first[i];
    return lost_pairs <= last.size() / 9;
}

Tuning tune(const DeviceInfo& device, const Workload& workload, const TuneSettings& settings,
            const TrialProgress& progress) {
    const Clock::time_point start = Clock::now();
    Tuning result;
    result.workload = workload;
    result.space = space_of(device, workload.key());
    const TunedValues defaults = result.best = result.space.defaults;
    std::string expected_check;
    const auto trial_of = [&](const std::vector<TunedValues>& candidates, std::uint32_t samples, double limit_s) {
        return run_trial(request_json(workload, settings.render, candidates, samples), candidates, expected_check,
                         limit_s, progress);
    };
    const Trial first = trial_of({defaults}, 1, kComparison_s);
    if (!first.error.empty())
        throw DeviceError(
            fmt::format("{}: the render with the default parameters failed: {}; remedy: run raya verify to find the "
                        "error",
                        workload.name(), first.error));
    expected_check = first.check;
    TunedValues found = defaults;
    for (const TunedValues& candidate : result.space.candidates) {
        if (candidate == defaults) continue;
        const double left_s = settings.seconds - seconds_since(start);
        result.complete = left_s > 0;
        if (!result.complete) break;
        const double limit_s = std::min(kCandidate_s, std::max(2.0, left_s));  // the last candidate may finish
        Trial trial = trial_of({found, candidate}, kSamples, limit_s);
        ++result.tried;
        if (trial.error.empty() && ratio_of(trial) <= kMaxWinRatio) found = candidate;
        if (!trial.error.empty() && (limit_s == kCandidate_s || !trial.error.starts_with("timeout")))
            result.dropped.push_back(std::move(trial));
    }
    result.seconds = seconds_since(start);
    if (found == defaults) return result;
    // The search's own measurement of `found` is biased: the best of many measurements is often a lucky one.
    const Trial comparison = trial_of({defaults, found}, kFinalSamples, kComparison_s);
    if (!wins_significantly(comparison)) return result;
    result.best = found;
    result.ratio = median_ratio(comparison.samples[1], comparison.samples[0]);
    return result;
}

namespace {

constexpr std::size_t kMinSamples = 2;  // of the search, before a slow candidate is dropped
constexpr double kDropRatio = 1.25;     // last time / first time with which a candidate is dropped

struct Variant {
    const char* name;
    AccelKind accel;
    std::uint32_t side;  // side of the default image in pixels
};
constexpr Variant kVariants[] = {{"none", AccelKind::kNone, 512},
                                 {"grid", AccelKind::kGrid, 256},
                                 {"bvh", AccelKind::kBvh, 256},
                                 {"torus", AccelKind::kNone, 256}};

const Variant& variant_named(const std::string& name) {
    for (const Variant& variant : kVariants)
        if (name == variant.name) return variant;
    throw UserError(fmt::format("--variants {}: must be none, grid, bvh or torus", name));
}

Scene scene_of(const TrialSetup& render, const Variant& variant) {
    constexpr const char* kSpheres = "scenes/spheres.nff";
    constexpr int kLevel = 4;
    std::vector<SceneRemark> remarks;  // not printed: the parent process prints them
    if (!render.scene.empty()) return read_scene_file(render.scene, render.strict ? nullptr : &remarks);
    if (variant.accel != AccelKind::kNone) return generate_balls(kLevel);
    return parse_nff(embedded_files().at(kSpheres), kSpheres);
}

RingSettings ring_settings(const Workload& workload, const ImageSize& size, std::uint32_t pes,
                           const KernelChoice& kernels) {
    RingSettings s;
    s.machine = machine_named("grande");
    s.mapping =
        make_mapping(cyclic_mapping(16 % size.width, Fold::kCyclic), size, std::min(pes, size.width * size.height));
    s.bounces = 8;
    s.format = workload.format;
    s.accel.kind = variant_named(workload.variant).accel;
    s.kernels = kernels;
    return s;
}

}  // namespace

TuningKey Workload::key() const {
    const Variant& named = variant_named(variant);
    return {.torus = variant == "torus", .accel = static_cast<std::uint32_t>(named.accel), .fp32 = format.is_fp32()};
}

std::string Workload::name() const {
    return (variant == "torus" ? "torus " : "ring " + variant + " ") + format_name(format);
}

std::vector<Workload> default_workloads() {
    return {{"none", parse_format("fp32")},
            {"none", parse_format("spa22")},
            {"grid", parse_format("fp32")},
            {"bvh", parse_format("fp32")},
            {"torus", parse_format("fp32")}};
}

double mean_seconds(const std::function<double()>& render) {
    constexpr double kMinSeconds = 0.02;
    double sum = 0;
    int calls = 0;
    for (; sum < kMinSeconds; ++calls) sum += render();
    return sum / calls;
}

void run_trial(int lines, const Json& request) {
    TrialSetup setup;
    request.at("device").get_to(setup.device);
    request.at("scene").get_to(setup.scene);
    request.at("kernel_dir").get_to(setup.kernel_dir);
    request.at("strict").get_to(setup.strict);
    request.at("pes").get_to(setup.pes);
    const Workload workload{request.at("variant"), parse_format(request.at("format"))};
    const Variant& variant = variant_named(workload.variant);
    ImageSize size{request.at("size").at(0), request.at("size").at(1)};
    if (size.width == 0) size = {variant.side, variant.side};
    const Scene scene = scene_of(setup, variant);
    Session session(choose_device(setup.device));
    std::vector<std::function<double()>> renders;  // each renders an image and returns its seconds
    const Json& candidates = request.at("candidates");
    const auto add = [&]<class Renderer>(const std::shared_ptr<Renderer>& renderer) {
        send_line(lines, {{"built", renders.size() + 1}});
        const RenderResult result = renderer->render();
        const std::string check = fmt::format("{}, {} rays", pixel_hash(result.image), ray_count(result.events));
        if (renders.size() + 1 == candidates.size()) send_line(lines, {{"check", check}});
        renders.push_back([renderer] { return renderer->render().render_s; });
    };
    for (const Json& values : candidates) {
        const KernelChoice kernels =
            with_values({.sources = {.folder = setup.kernel_dir}}, from_json<TunedValues>(values));
        const RingSettings ring = ring_settings(workload, size, setup.pes, kernels);
        if (workload.key().torus)
            add(std::make_shared<TorusRenderer>(session, scene, torus_settings_of(ring)));
        else
            add(std::make_shared<RingRenderer>(session, scene, ring));
    }
    const std::uint32_t count = request.at("samples");
    std::vector<std::vector<double>> samples(renders.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        for (std::size_t n = 0; n < renders.size(); ++n) samples[n].push_back(mean_seconds(renders[n]));
        if (count == kSamples && samples.front().size() >= kMinSamples &&
            min_of(samples.back()) > kDropRatio * min_of(samples.front()))
            break;
    }
    send_line(lines, {{"samples", samples}});
}

}  // namespace raya
