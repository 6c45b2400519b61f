#include "host/tune/workload.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/image/image.hpp"
#include "host/report/render_report.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff_reader.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_renderer.hpp"

namespace raya {
namespace {

// The rows of a table: the ways there are.
struct Way {
    const char* name;
    AccelKind accel;
    std::uint32_t side;  // of the picture, pixels
};
constexpr Way kWays[] = {{"none", AccelKind::kNone, 512},
                         {"grid", AccelKind::kGrid, 256},
                         {"bvh", AccelKind::kBvh, 256},
                         {"torus", AccelKind::kNone, 256}};

const Way& way_named(const std::string& name) {
    for (const Way& way : kWays)
        if (name == way.name) return way;
    throw UserError(fmt::format("--ways {}: must be none, grid, bvh or torus", name));
}

constexpr std::uint32_t kBounces = 8;

RingSettings ring_settings(const Workload& workload, const WorkloadPicture& picture, const KernelChoice& kernels) {
    RingSettings s;
    s.machine = machine_named("grande");
    const std::uint32_t pes = std::min(picture.pes, picture.size.width * picture.size.height);
    s.mapping = make_mapping(cyclic_mapping(16 % picture.size.width, Fold::kCyclic), picture.size, pes);
    s.bounces = kBounces;
    s.format = workload.format;
    s.accel.kind = way_named(workload.way).accel;
    s.kernels = kernels;
    return s;
}

TorusSettings torus_settings(const Workload& workload, const WorkloadPicture& picture, const KernelChoice& kernels) {
    TorusSettings s = usual_torus(picture.size);
    s.bounces = kBounces;
    s.format = workload.format;
    s.kernels = kernels;
    return s;
}

const EventCounts& events_of(const RingResult& result) { return result.all.events; }
const EventCounts& events_of(const TorusResult& result) { return result.events; }

template <class Renderer>
TrialRender render_of(std::shared_ptr<Renderer> renderer, const std::function<void()>& built) {
    built();
    const auto first = renderer->render();
    return {.build_s = first.build_s,
            .check = fmt::format("{}, {} rays", pixel_hash(first.image), ray_count(events_of(first))),
            .image_s = [renderer] { return renderer->render().render_s; }};
}

}  // namespace

TunedFor Workload::what() const {
    const Way& named = way_named(way);
    return {.torus = way == "torus", .accel = static_cast<std::uint32_t>(named.accel), .fp32 = format.is_fp32()};
}

std::string Workload::name() const { return (way == "torus" ? "torus " : "ring " + way + " ") + format_name(format); }

std::vector<Workload> usual_workloads() {
    return {{"none", parse_format("fp32")},
            {"none", parse_format("spa22")},
            {"grid", parse_format("fp32")},
            {"bvh", parse_format("fp32")},
            {"torus", parse_format("fp32")}};
}

WorkloadPicture picture_of(const Workload& workload, const Scene* given, const ImageSize& size, std::uint32_t pes) {
    const Way& way = way_named(workload.way);
    const auto own_scene = [&] {
        constexpr const char* kSpheres = "scenes/spheres.nff";
        constexpr int kLevel = 4;
        return way.accel == AccelKind::kNone ? parse_nff(embedded_files().at(kSpheres), kSpheres)
                                             : generate_balls(kLevel);
    };
    return {given ? *given : own_scene(), size.width ? size : ImageSize{way.side, way.side}, pes};
}

TrialRender prepare_render(Session& session, const Workload& workload, const WorkloadPicture& picture,
                           const KernelChoice& kernels, const std::function<void()>& built) {
    if (workload.way == "torus")
        return render_of(
            std::make_shared<TorusRenderer>(session, picture.scene, torus_settings(workload, picture, kernels)), built);
    return render_of(std::make_shared<RingRenderer>(session, picture.scene, ring_settings(workload, picture, kernels)),
                     built);
}

}  // namespace raya
