// raya devices: lists the OpenCL devices of all platforms.
#include <fmt/core.h>

#include "host/cl/device.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/error.hpp"
#include "host/report/table.hpp"

namespace raya {
namespace {

const char* yes_or_no(bool value) { return value ? "yes" : "no"; }

void list_devices() {
    std::vector<std::vector<std::string>> rows = {{"#", "device", "platform", "type", "units", "lanes", "group",
                                                   "local KB", "global MB", "div/sqrt exact", "fma", "profiling",
                                                   "usable"}};
    std::vector<std::string> versions;
    for (const cl::Device& device : all_devices()) {
        const DeviceInfo info = device_info(device);
        rows.push_back(
            {std::to_string(rows.size() - 1), info.name, info.platform, info.type, std::to_string(info.compute_units),
             std::to_string(default_lanes(info)), std::to_string(default_group_size(info)),
             fmt::format("{}{}", info.local_memory_bytes / 1024, info.local_memory_is_dedicated ? "" : " (global)"),
             std::to_string(info.global_memory_bytes >> 20), yes_or_no(info.correctly_rounded_divide_sqrt),
             yes_or_no(info.fused_multiply_add), yes_or_no(info.profiling), yes_or_no(unusable_reason(info).empty())});
        versions.push_back(fmt::format("{}: {}, driver {}{}{}", versions.size(), info.version, info.driver,
                                       info.il_versions.empty() ? "" : ", IL ", info.il_versions));
    }
    if (versions.empty()) choose_device("");  // throws the error for a computer without devices
    fmt::print("{}\n", text_table(rows));
    for (const std::string& version : versions) fmt::print("{}\n", version);
    fmt::print(
        "\nlanes, group: the defaults of --lanes and --group. --device and RAYA_DEVICE take a number, a type, or "
        "part of a name or version.\nThe options in RAYA_BUILD_OPTIONS are added to every kernel's build "
        "options; the report lists them. For example, RAYA_BUILD_OPTIONS=-cl-opt-disable shows whether the compiler's "
        "optimiser causes a wrong result.\n");
}

}  // namespace

void add_devices_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("devices", "List every OpenCL device of every platform, with its main properties");
    add_examples(*command, {{"raya devices", "List the devices with their numbers"},
                            {"raya devices >devices.txt", "Write the list to a file"}});
    command->callback(list_devices);
}

}  // namespace raya
