#include "host/cli/scene_input.hpp"

#include <fmt/core.h>

#include <set>
#include <sstream>

#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/cl/program.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/mesh/mesh_file.hpp"
#include "host/model/unit_text.hpp"

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

std::vector<std::string> scene_extensions() {
    std::vector<std::string> extensions = {".nff"};
    extensions.insert(extensions.end(), mesh_extensions().begin(), mesh_extensions().end());
    return extensions;
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

}  // namespace raya
