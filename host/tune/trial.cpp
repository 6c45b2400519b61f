// The process of a trial.

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
#include "host/tune/store.hpp"
#include "host/tune/tune.hpp"

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
    s.bounces = kBounces;
    s.format = workload.format;
    s.accel.kind = variant_named(workload.variant).accel;
    s.kernels = kernels;
    return s;
}

TorusSettings torus_settings(const Workload& workload, const ImageSize& size, const KernelChoice& kernels) {
    TorusSettings s = default_torus(size);
    s.bounces = kBounces;
    s.format = workload.format;
    s.kernels = kernels;
    return s;
}

/// Renders one image with kernels that are already built. Returns the seconds from the packed scene to the image.
using TimedRender = std::function<double()>;

// Renders the first image. Writes the line "check" if `lines` is a descriptor. Returns a function that renders further
// images.
template <class Renderer>
TimedRender first_image(int lines, std::shared_ptr<Renderer> renderer) {
    const RenderResult result = renderer->render();
    const std::string check = fmt::format("{}, {} rays", pixel_hash(result.image), ray_count(result.events));
    if (lines >= 0) send_line(lines, {{"check", check}});
    return [renderer] { return renderer->render().render_s; };
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

// `request`: see request_json() in tune.cpp.
void run_trial(int lines, const Json& request) {
    const auto number = [](const Json& value) { return static_cast<std::uint32_t>(json_integer(value, UINT32_MAX)); };
    const Json& sides = json_array(request.at("size"));
    const TrialSetup setup{.device = json_text(request.at("device")),
                           .scene = json_text(request.at("scene")),
                           .kernel_dir = json_text(request.at("kernel_dir")),
                           .strict = json_integer(request.at("strict"), 1) == 1,
                           .size = {number(sides.at(0)), number(sides.at(1))},
                           .pes = number(request.at("pes"))};
    const Workload workload{json_text(request.at("variant")), parse_format(json_text(request.at("format")))};
    const Variant& variant = variant_named(workload.variant);
    const ImageSize size = setup.size.width ? setup.size : ImageSize{variant.side, variant.side};
    const Scene scene = scene_of(setup, variant);
    Session session(choose_device(setup.device));
    std::vector<TimedRender> renders;
    const Json& candidates = json_array(request.at("candidates"));
    for (const Json& values : candidates) {
        const int check_lines = renders.size() + 1 == candidates.size() ? lines : -1;
        const KernelChoice kernels = with_values({.sources = {.folder = setup.kernel_dir}}, values_of(values));
        const auto render_with = [&]<class Renderer>(std::shared_ptr<Renderer> renderer) {
            send_line(lines, {{"built", renders.size() + 1}});
            renders.push_back(first_image(check_lines, std::move(renderer)));
        };
        if (workload.key().torus)
            render_with(std::make_shared<TorusRenderer>(session, scene, torus_settings(workload, size, kernels)));
        else
            render_with(
                std::make_shared<RingRenderer>(session, scene, ring_settings(workload, size, setup.pes, kernels)));
    }
    const bool stops_early = json_integer(request.at("stop_early"), 1) == 1;
    std::vector<std::vector<double>> samples(renders.size());
    for (std::uint32_t i = 0; i < number(request.at("samples")); ++i) {
        for (std::size_t n = 0; n < renders.size(); ++n) samples[n].push_back(mean_seconds(renders[n]));
        if (stops_early && samples.front().size() >= kMinSamples &&
            *std::ranges::min_element(samples.back()) > kDropRatio * *std::ranges::min_element(samples.front()))
            break;
    }
    send_line(lines, {{"samples", samples}});
}

}  // namespace raya
