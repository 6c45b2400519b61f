#include "host/verify/worker.hpp"

#include <fmt/core.h>

#include "host/base/json.hpp"
#include "host/base/own_process.hpp"
#include "host/cl/driver_call.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

// What a driver says need not be UTF-8.
void send(int lines, const Json& object) { send_line(lines, object.dump()); }

// Names from which somebody sees what --only takes: the first of each layer.
std::string some_names(const std::vector<std::string>& names) {
    std::string text, layer;
    for (const std::string& name : names) {
        const std::string own = name.substr(0, name.find(' '));
        if (own != layer) text += "\n  " + name;
        layer = own;
    }
    return text;
}

void refuse_no_checks(const cl::Device& device, const VerifySettings& settings) {
    if (!check_names(device, settings).empty()) return;
    VerifySettings any = settings;
    any.only.clear();
    throw UserError(fmt::format(
        "--only \"{}\": no check of {} has this in \"LAYER NAME\"; the layers are number, geometry, machine and image, "
        "checks are{}{}",
        settings.only, device_info(device).name, some_names(check_names(device, any)),
        settings.depth == Depth::kFull ? "" : "\n  ... and --full has more"));
}

void run(int lines, const std::string& wanted, std::size_t index, const VerifySettings& settings) {
    const NamedDevices named = named_devices(wanted);
    if (index == 0 && settings.done == 0)
        for (const cl::Device& device : named.devices) refuse_no_checks(device, settings);
    const cl::Device& device = named.devices.at(index);
    const DeviceInfo info = device_info(device);
    send(lines, {{"devices", named.devices.size()},
                 {"left_out", named.left_out},
                 {"name", info.name},
                 {"platform", info.platform},
                 {"version", info.version},
                 {"driver", info.driver}});
    verify(device, settings,
           {.started =
                [&](const std::string& layer, const std::string& name) {
                    send(lines, {{"started", {{"layer", layer}, {"name", name}}}});
                },
            .finished =
                [&](const Check& check) {
                    send(lines, {{"check", to_json(check)}});
                }});
    send(lines, {{"ended", true}});
}

}  // namespace

NamedDevices named_devices(const std::string& wanted) {
    if (wanted != "all") return {{choose_device(wanted)}, {}};
    NamedDevices named;
    for (const cl::Device& device : all_devices()) {
        const DeviceInfo info = device_info(device);
        if (info.available && info.compiler_available)
            named.devices.push_back(device);
        else
            named.left_out.push_back(
                fmt::format("{} ({}): not available, or without a compiler; left out", info.name, info.platform));
    }
    if (named.devices.empty()) choose_device("");  // throws, with the remedy
    return named;
}

void run_worker(int lines, const std::string& wanted, std::size_t index, const VerifySettings& settings) {
    leave_driver_crashes();  // the supervisor tells of them
    keep_lines_to_oneself(lines);
    const auto stop = [&](const std::exception& error, const char* kind) {
        send(lines, {{"error", error.what()}, {"kind", kind}});
    };
    try {
        run(lines, wanted, index, settings);
    } catch (const UserError& error) {
        stop(error, "user");
    } catch (const DeviceError& error) {
        stop(error, "device");
    } catch (const std::exception& error) {
        stop(error, "internal");
    }
}

}  // namespace raya
