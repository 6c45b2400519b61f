// kernel_builds TO [GROUP [KERNELS]]: writes the source of every kernel file to the folder TO, as host/cl passes it to
// a GPU's driver, and the build options to TO/builds.json. tools/gpu_check, which compiles without a device, runs this
// program. GROUP: number of work-items in a work-group, 0 for raya's default on a GPU. KERNELS: a folder that is used
// instead of kernels/.
#include <fmt/core.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "host/base/json.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/kernel_options.hpp"
#include "kernels/shared/bvh.h"

namespace raya {
namespace {

struct Build {
    std::string file, variant;
    KernelOptions options;
};

DeviceInfo typical_gpu() {
    DeviceInfo device;
    device.name = "a GPU";
    device.type = "gpu";
    device.max_group_size = 1024;
    device.native_float_width = 1;
    device.correctly_rounded_divide_sqrt = device.fused_multiply_add = true;
    return device;
}

const std::vector<std::pair<std::string, std::uint32_t>> kAccelerators = {{" grid", RAYA_ACCEL_GRID},
                                                                          {" bvh", RAYA_ACCEL_BVH}};
constexpr std::uint32_t kBvhDepth = 5;  // number of levels of nodes, for up to 16^5 objects

KernelOptions with_accel(KernelOptions options, std::uint32_t accel) {
    options.words_local = false;  // scenes that need a grid or BVH rarely fit in local memory
    options.accel = accel;
    options.stack = accel == RAYA_ACCEL_BVH ? (RAYA_BVH_WIDTH - 1) * kBvhDepth : 0;
    return options;
}

// Returns builds of the kernels that compute in a number format: for all kinds of objects, for spheres only, with each
// accelerator, and for devices without exact arithmetic. `general`: the options for all kinds of objects.
std::vector<Build> builds_in(const std::string& format, const KernelOptions& general) {
    KernelOptions spheres = general, single_item = general;
    spheres.polygons = spheres.patches = spheres.cones = false;
    single_item.group_size = 1;
    single_item.words_local = false;
    KernelOptions refined = single_item;
    refined.exact_divide = refined.exact_fma = false;
    std::vector<Build> builds = {
        {"ring/trace.cl", format, general},
        {"ring/trace.cl", format + " spheres", spheres},
        {"ring/turn.cl", format, general},
        {"ring/filter.cl", format, general},
        {"ring/contrast.cl", format, general},
        {"torus/inject.cl", format, general},
        {"torus/trace_voxel.cl", format, general},
        {"torus/compose.cl", format, single_item},
        {"number/operations.cl", format, general},
        {"checks/numbers.cl", format, single_item},
        {"checks/numbers.cl", format + " refined", refined},
    };
    for (const auto& [suffix, accel] : kAccelerators) {
        builds.push_back({"ring/trace.cl", format + suffix, with_accel(general, accel)});
        builds.push_back({"checks/hits.cl", format + suffix, with_accel(single_item, accel)});
    }
    return builds;
}

std::vector<Build> all_builds(std::uint32_t group) {
    KernelOptions options;
    options.lanes = default_lanes(typical_gpu());
    options.group_size = group ? group : default_group_size(typical_gpu());
    std::vector<Build> all;
    for (const char* file :
         {"torus/route.cl", "torus/accept.cl", "torus/exchange.cl", "checks/machine.cl"})  // independent of the format
        all.push_back({file, "any", options});
    for (const NumberFormat& format : {NumberFormat{}, NumberFormat{6, 15, false}}) {
        options.format = format;
        options.filter = filters_are_valid(format, 1);
        for (Build& build : builds_in(format_name(format), options)) all.push_back(std::move(build));
    }
    options.costs = true;
    all.push_back({"torus/trace_voxel.cl", format_name(options.format) + " costs", options});
    return all;
}

void write(const std::filesystem::path& to, std::uint32_t group, const KernelSources& sources) {
    std::filesystem::create_directories(to);
    Json list = Json::array();
    for (const Build& build : all_builds(group)) {
        std::string name = fmt::format("{} {}.cl", build.file.substr(0, build.file.size() - 3), build.variant);
        for (char& letter : name)
            if (letter == '/' || letter == ' ') letter = '_';
        write_whole_file(to / name, kernel_source(build.file, sources));
        list.push_back({{"source", name},
                        {"file", build.file},
                        {"variant", build.variant},
                        {"group", build.options.group_size},
                        {"options", build_options(build.options, typical_gpu())}});
    }
    write_whole_file(to / "builds.json", list.dump(1));
}

}  // namespace
}  // namespace raya

int main(int argc, char** argv) {
    if (argc < 2 || argc > 4) {
        std::fputs("usage: kernel_builds TO [GROUP [KERNELS]]\n", stderr);
        return 2;
    }
    try {
        const auto group = static_cast<std::uint32_t>(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 0);
        raya::write(argv[1], group, {.folder = argc > 3 ? argv[3] : ""});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "kernel_builds: %s\n", error.what());
        return 2;
    }
}
