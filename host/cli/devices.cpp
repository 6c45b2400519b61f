// raya devices: lists the OpenCL devices of all platforms.
#include <fmt/core.h>

#include "host/cl/device.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"

namespace raya {
namespace {

// Lines of at most 80 characters, unless a driver's own names are longer.
std::string device_text(std::size_t number, const DeviceInfo& info) {
    std::string usable = unusable_reason(info).empty() ? "usable" : "not usable: " + unusable_reason(info);
    for (const auto& [has, what] : {std::pair{info.correctly_rounded_divide_sqrt, "exact division and square root"},
                                    {info.fused_multiply_add, "fma"},
                                    {info.profiling, "profiling"}})
        if (has) usable += fmt::format(", {}", what);
    return fmt::format(
        "{}  {}\n   {}, driver {}\n   {}{}{}\n   {}, {} units, {} KB of {} memory, {} MB of global memory\n"
        "   {} lanes and groups of {} by default\n   {}\n\n",
        number, info.name, info.platform, info.driver, info.version, info.il_versions.empty() ? "" : ", IL ",
        info.il_versions, info.type, info.compute_units, info.local_memory_bytes / 1024,
        info.local_memory_is_dedicated ? "local" : "local (in global)", info.global_memory_bytes >> 20,
        default_lanes(info), default_group_size(info), usable);
}

void list_devices() {
    const std::vector<cl::Device> devices = all_devices();
    if (devices.empty()) choose_device("");  // throws the error for a computer without devices
    for (std::size_t i = 0; i < devices.size(); ++i) fmt::print("{}", device_text(i, device_info(devices[i])));
    fmt::print(
        "--device and RAYA_DEVICE take a number, a type, or part of a name or version; --lanes\n"
        "and --group replace the defaults. RAYA_BUILD_OPTIONS=-cl-opt-disable shows whether\n"
        "the compiler's optimiser causes a wrong result.\n");
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
