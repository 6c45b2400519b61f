#include "host/cli/scene_input.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <utility>

#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/cl/program.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"
#include "host/mesh/mesh_file.hpp"
#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/torus/torus_plan.hpp"

namespace raya {

void Warnings::add(const std::string& text) {
    warn("warning: " + text);
    texts_.push_back(text);
}

void add_strict_option(CLI::App& command, bool& strict) {
    const OptionGroup group(command, kFiles);
    command.add_flag(
        "--strict", strict,
        "Refuse a scene with facets that are degenerate or not planar, or with entities that NFF does not define or "
        "that raya does not use in meshes; without --strict, raya omits or triangulates such facets and skips such "
        "entities, with a warning");
}

SceneInput read_scene(const std::string& file, bool strict) {
    SceneInput input;
    const auto warn_of_remarks = [&] {
        for (const SceneRemark& remark : input.remarks) input.warnings.add(remark_text(input_name(file), remark));
    };
    try {
        input.scene = read_scene_file(file, strict ? nullptr : &input.remarks);
    } catch (const UserError&) {
        warn_of_remarks();  // the remarks may explain the error
        throw;
    }
    warn_of_remarks();
    log_message(
        kVerbose,
        fmt::format("{}: {}, {}, {} x {} pixels", input_name(file), counted(input.scene.object_count(), "object"),
                    counted(input.scene.lights.size(), "light"), input.scene.view.width, input.scene.view.height));
    return input;
}

void warn_of_build_options(Warnings& warnings) {
    static const std::set<std::string> harmless_options = {"--il",
                                                           "-cl-opt-disable",
                                                           "-cl-fp32-correctly-rounded-divide-sqrt",
                                                           "-cl-kernel-arg-info",
                                                           "-cl-uniform-work-group-size",
                                                           "-cl-nv-verbose",
                                                           "-g",
                                                           "-w",
                                                           "-Werror"};
    std::istringstream options(user_build_options());
    for (std::string option; options >> option;)
        if (!harmless_options.contains(option))
            warnings.add(fmt::format("RAYA_BUILD_OPTIONS: {} may change pixels and counts", option));
}

void warn_of_slow_search(const Scene& scene, bool accelerated, Warnings& warnings) {
    constexpr std::size_t kManyObjects = 100'000;
    if (accelerated || scene.object_count() < kManyObjects) return;
    warnings.add(fmt::format("{}: every ray is tested against {} objects; --accel bvh finds the same hits faster",
                             scene.name, scene.object_count()));
}

void warn_of_lost_objects(const Scene& scene, const LengthScale& scale, const NumberFormat& format,
                          Warnings& warnings) {
    if (scale.vanishing_count == 0) return;
    warnings.add(
        fmt::format("{}: {} spheres, cones or checkers are invisible: they are smaller than {:.3g}, the minimum of {} "
                    "in a scene with lengths up to {:.3g}; remedy: --format fp32",
                    scene.name, scale.vanishing_count, scale.min_visible, format_name(format), scale.largest_length));
}

namespace {

constexpr std::array<AccelKind, 3> kAccelKinds = {AccelKind::kNone, AccelKind::kBvh, AccelKind::kGrid};

void set_missing(AccelNeed& need, const DoesNotFit& refusal) {
    need.pe_bytes = refusal.needed_bytes;
    need.missing_bytes = refusal.needed_bytes - refusal.memory_bytes;
    need.refusal = refusal.what();
}

}  // namespace

SceneNeeds::SceneNeeds(const RenderOptions& render, const TorusOptions& torus, const Scene& scene)
    : render_(render), torus_(torus), scene_(scene) {}

const FormatFit& SceneNeeds::fit_of(const NumberFormat& format) {
    const std::string name = format_name(format);
    const auto known = std::ranges::find(formats_, name, &FormatFit::format);
    if (known != formats_.end()) return *known;
    FormatFit fit{name, {}, {}};
    try {
        fit.scale = length_scale(scene_, format);
    } catch (const UserError& error) {
        fit.refusal = error.what();
    }
    return formats_.emplace_back(std::move(fit));
}

const SceneNeeds::PackedSize& SceneNeeds::size_of(const RingSettings& settings, const LengthScale& scale) {
    const std::string format = format_name(settings.format);
    const auto [entry, added] = sizes_.try_emplace(format + ' ' + accel_text(settings.accel));
    PackedSize& size = entry->second;
    if (!added) return size;
    try {
        if (!last_packed_ || last_packed_->first != format)
            last_packed_.emplace(format, pack_for_ring(scene_, settings, scale));
        size.words = last_packed_->second.words().size();
        if (settings.accel.kind == AccelKind::kNone) return size;
        PackedJob job = last_packed_->second;
        size.accel = append_accel(job, settings);
        size.words = job.words().size();
    } catch (const UserError& error) {  // the scene has more words than 32-bit addresses can reach
        size.refusal = error.what();
    }
    return size;
}

AccelNeed SceneNeeds::need_of(const RingSettings& settings, const FormatFit& fit) {
    AccelNeed need;
    need.accel = accel_text(settings.accel);
    need.refusal = fit.refusal;
    if (!need.refusal.empty()) return need;
    const PackedSize& size = size_of(settings, fit.scale);
    need.words = size.words;
    need.summary = size.accel;
    need.refusal = size.refusal;
    if (!need.refusal.empty()) return need;
    try {
        need.pe_bytes = plan_pe_memory(settings.machine, pe_demand(settings, scene_.name, size.words)).bytes();
    } catch (const DoesNotFit& refusal) {
        set_missing(need, refusal);
    }
    return need;
}

MachineNeeds SceneNeeds::ring_needs(const RenderOptions& options) {
    RingSettings settings = ring_settings(options, scene_);
    check_antialias(settings.antialias.method, settings.mapping, settings.dynamic.has_value());
    MachineNeeds machine{.machine = options.machine,
                         .format = format_name(settings.format),
                         .pes = settings.mapping.pes,
                         .memory_bytes = settings.machine.pe_memory_bytes,
                         .needs = {},
                         .refusal = {}};
    const FormatFit fit = fit_of(settings.format);
    const std::string default_accel = accel_text(settings.accel);
    std::vector<Accel> accels;
    for (const AccelKind kind : kAccelKinds)
        if (options.accel.empty()) accels.push_back({kind, {}});
    if (accels.empty()) accels.push_back(settings.accel);
    for (const Accel& accel : accels) {
        settings.accel = accel;
        machine.needs.push_back(need_of(settings, fit));
        machine.needs.back().is_default = options.accel.empty() && machine.needs.back().accel == default_accel;
    }
    return machine;
}

MachineNeeds SceneNeeds::torus_needs(const RenderOptions& options) {
    const TorusSettings settings = torus_settings(options, torus_, scene_);
    MachineNeeds machine{.machine = options.machine,
                         .format = format_name(settings.format),
                         .pes = raya_nodes(settings.torus),
                         .memory_bytes = settings.memory_bytes,
                         .needs = {},
                         .refusal = {}};
    AccelNeed need;
    need.accel = "voxels";
    need.is_default = true;
    need.refusal = fit_of(settings.format).refusal;
    try {
        if (need.refusal.empty()) {
            const NodeNeeds needs = node_needs(scene_, settings);
            need.words = needs.words;
            need.pe_bytes = needs.bytes;
        }
    } catch (const DoesNotFit& refusal) {
        set_missing(need, refusal);
    } catch (const UserError& error) {
        need.refusal = error.what();
    }
    machine.needs.push_back(need);
    return machine;
}

MachineNeeds SceneNeeds::needs_of(const std::string& machine) {
    RenderOptions options = render_;
    options.machine = machine;
    return machine_named(machine).kind == MachineKind::kTorus ? torus_needs(options) : ring_needs(options);
}

}  // namespace raya
