#include "host/tune/trial.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "host/base/child_process.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/image/image.hpp"
#include "host/mesh/mesh_file.hpp"
#include "host/report/render_report.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/tune/search.hpp"
#include "host/tune/store.hpp"

namespace raya {
namespace {

constexpr std::size_t kMinSamples = 2;  // number of samples before stop_early may end a trial
constexpr double kDropRatio = 1.25;     // stop_early ends a trial if last time / first time exceeds this ratio

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

constexpr std::uint32_t kBounces = 8;

struct TrialInput {
    Scene scene;
    ImageSize size;
};

Scene scene_of(const TrialSetup& render, const Variant& variant) {
    constexpr const char* kSpheres = "scenes/spheres.nff";
    constexpr int kLevel = 4;
    std::vector<SceneRemark> remarks;  // not printed: the parent process prints them
    if (!render.scene.empty()) return read_scene_file(render.scene, render.strict ? nullptr : &remarks);
    if (variant.accel != AccelKind::kNone) return generate_balls(kLevel);
    return parse_nff(embedded_files().at(kSpheres), kSpheres);
}

TrialInput input_of(const TrialRequest& request) {
    const Variant& variant = variant_named(request.workload.variant);
    const ImageSize& size = request.render.size;
    return {scene_of(request.render, variant), size.width ? size : ImageSize{variant.side, variant.side}};
}

RingSettings ring_settings(const TrialRequest& request, const ImageSize& size, const KernelChoice& kernels) {
    RingSettings s;
    s.machine = machine_named("grande");
    const std::uint32_t pes = std::min(request.render.pes, size.width * size.height);
    s.mapping = make_mapping(cyclic_mapping(16 % size.width, Fold::kCyclic), size, pes);
    s.bounces = kBounces;
    s.format = request.workload.format;
    s.accel.kind = variant_named(request.workload.variant).accel;
    s.kernels = kernels;
    return s;
}

TorusSettings torus_settings(const TrialRequest& request, const ImageSize& size, const KernelChoice& kernels) {
    TorusSettings s = default_torus(size);
    s.bounces = kBounces;
    s.format = request.workload.format;
    s.kernels = kernels;
    return s;
}

const EventCounts& events_of(const RingResult& result) { return result.all.events; }
const EventCounts& events_of(const TorusResult& result) { return result.events; }

/// Renders one image with kernels that are already built. Returns the seconds from the packed scene to the image.
using TimedRender = std::function<double()>;

// Writes the lines "built" and "check" of candidate `number`, whose kernels `renderer` has built. Renders the first
// image for "check". Returns a function that renders further images.
template <class Renderer>
TimedRender prepare_candidate(int lines, std::size_t number, std::shared_ptr<Renderer> renderer) {
    send_line(lines, {{"built", number}});
    const auto first_result = renderer->render();
    const std::string check =
        fmt::format("{}, {} rays", pixel_hash(first_result.image), ray_count(events_of(first_result)));
    send_line(lines, {{"check", check}, {"build_s", first_result.build_s}});
    return [renderer] { return renderer->render().render_s; };
}

double min_seconds(const std::vector<double>& seconds) { return *std::min_element(seconds.begin(), seconds.end()); }

std::vector<std::vector<double>> samples_of(const std::vector<TimedRender>& renders, const TrialRequest& request) {
    std::vector<std::vector<double>> samples(renders.size());
    for (std::uint32_t i = 0; i < request.samples; ++i) {
        for (std::size_t n = 0; n < renders.size(); ++n) samples[n].push_back(mean_seconds(renders[n]));
        const bool may_stop = request.stop_early && samples.front().size() >= kMinSamples;
        if (may_stop && min_seconds(samples.back()) > kDropRatio * min_seconds(samples.front())) break;
    }
    return samples;
}

TrialRequest request_of(const Json& json) {
    const auto number = [](const Json& value) { return static_cast<std::uint32_t>(value.integer(UINT32_MAX)); };
    const std::vector<Json>& size = json.at("size").elements();
    TrialRequest request{.render = {.device = json.at("device").text(),
                                    .scene = json.at("scene").text(),
                                    .kernel_dir = json.at("kernel_dir").text(),
                                    .strict = json.at("strict").integer(1) == 1,
                                    .size = {number(size.at(0)), number(size.at(1))},
                                    .pes = number(json.at("pes"))},
                         .workload = {json.at("variant").text(), parse_format(json.at("format").text())},
                         .candidates = {},
                         .samples = number(json.at("samples")),
                         .stop_early = json.at("stop_early").integer(1) == 1};
    for (const Json& values : json.at("candidates").elements()) request.candidates.push_back(values_of(values));
    return request;
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

Json to_json(const TrialRequest& request) {
    Json candidates = Json::array();
    for (const TunedValues& values : request.candidates) candidates.push_back(to_json(values));
    const TrialSetup& render = request.render;
    return {{"device", render.device},
            {"scene", render.scene},
            {"kernel_dir", render.kernel_dir},
            {"strict", render.strict ? 1 : 0},
            {"size", std::array{render.size.width, render.size.height}},
            {"pes", render.pes},
            {"variant", request.workload.variant},
            {"format", format_name(request.workload.format)},
            {"candidates", candidates},
            {"samples", request.samples},
            {"stop_early", request.stop_early ? 1 : 0}};
}

double median_ratio(const std::vector<double>& seconds, const std::vector<double>& reference) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(seconds.size(), reference.size()); ++i)
        ratios.push_back(seconds[i] / reference[i]);
    if (ratios.empty()) return 1;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle;
}

double ratio_of(const Trial& trial) {
    if (trial.samples.empty() || trial.samples.front().empty() || trial.samples.back().empty()) return 1;
    const std::vector<double>&last = trial.samples.back(), &first = trial.samples.front();
    return std::max(min_seconds(last) / min_seconds(first), median_ratio(last, first));
}

bool wins_significantly(const Trial& trial) {
    if (trial.status != TrialStatus::kCorrect || ratio_of(trial) > kMaxWinRatio) return false;
    const std::vector<double>&last = trial.samples.back(), &first = trial.samples.front();
    std::size_t lost_pairs = 0;
    for (std::size_t i = 0; i < last.size(); ++i) lost_pairs += last[i] >= first[i];
    return lost_pairs <= last.size() / 9;
}

double mean_seconds(const std::function<double()>& render) {
    constexpr double kMinSeconds = 0.02;
    double sum = 0;
    int calls = 0;
    for (; sum < kMinSeconds; ++calls) sum += render();
    return sum / calls;
}

void run_trial(int lines, const Json& json) {
    const TrialRequest request = request_of(json);
    const TrialInput input = input_of(request);
    Session session(choose_device(request.render.device));
    std::vector<TimedRender> renders;
    for (const TunedValues& values : request.candidates) {
        const KernelChoice kernels = with_values({.sources = {.folder = request.render.kernel_dir}}, values);
        const std::size_t number = renders.size();
        if (request.workload.key().torus)
            renders.push_back(prepare_candidate(
                lines, number,
                std::make_shared<TorusRenderer>(session, input.scene, torus_settings(request, input.size, kernels))));
        else
            renders.push_back(prepare_candidate(
                lines, number,
                std::make_shared<RingRenderer>(session, input.scene, ring_settings(request, input.size, kernels))));
    }
    send_line(lines, {{"samples", samples_of(renders, request)}});
}

}  // namespace raya
