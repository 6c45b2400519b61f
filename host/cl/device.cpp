#include "host/cl/device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/base/module.hpp"
#include "host/cl/driver.hpp"
#include "host/cl/error_names.hpp"
#include "host/cl/kernel_source.hpp"

namespace raya {
namespace {

std::string type_name(cl_device_type type) {
    if (type & CL_DEVICE_TYPE_GPU) return "gpu";
    if (type & CL_DEVICE_TYPE_CPU) return "cpu";
    return "other";
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

std::string pci_address_of(const cl::Device& device) {
    cl_device_pci_bus_info_khr pci{};
    if (::clGetDeviceInfo(device(), CL_DEVICE_PCI_BUS_INFO_KHR, sizeof pci, &pci, nullptr) != CL_SUCCESS) return {};
    if (pci.pci_domain + pci.pci_bus + pci.pci_device + pci.pci_function == 0) return {};  // PoCL 7 for CPUs
    return fmt::format("{:04x}:{:02x}:{:02x}.{:x}", pci.pci_domain, pci.pci_bus, pci.pci_device, pci.pci_function);
}

std::string full_name(const DeviceInfo& device) { return device.platform + " " + device.name; }

std::string device_list(const std::vector<DeviceInfo>& devices) {
    std::string list;
    for (std::size_t i = 0; i < devices.size(); ++i)
        list += fmt::format("\n  {}: {} ({}{})", i, full_name(devices[i]), devices[i].type,
                            unusable_reason(devices[i]).empty() ? "" : ", not usable");
    return list;
}

/// Returns the indices, ascending, of the usable devices of a type.
std::vector<std::size_t> usable_devices(const std::string& type, const std::vector<DeviceInfo>& devices) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < devices.size(); ++i)
        if (devices[i].type == type && unusable_reason(devices[i]).empty()) found.push_back(i);
    return found;
}

std::size_t default_index(const std::vector<DeviceInfo>& devices, std::size_t ordinal) {
    for (const char* type : {"gpu", "cpu", "other"}) {
        const std::vector<std::size_t> found = usable_devices(type, devices);
        if (!found.empty()) return found[ordinal % found.size()];
    }
    throw DeviceError((uses_il() ? "no available OpenCL device accepts SPIR-V; remedy: omit --il; devices:"
                                 : "no available OpenCL device has a compiler; see clinfo; devices:") +
                      device_list(devices));
}

/// Interprets `wanted` as a device number, else as a type, else as part of a platform, name, version or driver. Returns
/// the index of the first device that matches (for a type: of the first usable device), or devices.size() if no device
/// matches.
std::size_t named_index(const std::string& wanted, const std::vector<DeviceInfo>& devices) {
    const auto number = parsed_number<std::size_t>(wanted);
    if (number && *number < devices.size()) return *number;
    const std::string part = lower_case(wanted);
    const std::vector<std::size_t> usable = usable_devices(part, devices);
    if (!usable.empty()) return usable.front();
    const auto found = std::ranges::find_if(devices, [&part](const DeviceInfo& d) {
        return lower_case(fmt::format("{} {} {} {}", d.platform, d.name, d.version, d.driver)).find(part) !=
               std::string::npos;
    });
    return static_cast<std::size_t>(found - devices.begin());
}

}  // namespace

std::vector<cl::Device> all_devices() {
    set_driver_cache_folder();
    const DeviceSearch search;
    std::vector<cl::Platform> platforms;
    try {
        const DriverCall call("looking for platforms");
        cl::Platform::get(&platforms);
    } catch (const cl::Error& error) {
        constexpr cl_int kPlatformNotFound = -1001;  // from the ICD loader: no driver is installed
        if (error.err() != kPlatformNotFound) throw device_error(error.what(), error.err(), "looking for platforms");
    }
    std::vector<cl::Device> all;
    std::vector<std::string> errors;
    for (const cl::Platform& platform : platforms) {
        std::string name = "without a name";
        try {
            std::vector<cl::Device> devices;
            guarded("looking for devices", [&] {
                name = platform.getInfo<CL_PLATFORM_NAME>();
                platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
            });
            for (const cl::Device& device : devices) device_info(device);  // a driver may hang or fail only here
            for (const cl::Device& device : devices)  // a driver with two ICD files reports its devices twice
                if (std::ranges::none_of(all, [&](const cl::Device& d) { return d() == device(); }))
                    all.push_back(device);
        } catch (const DeviceError& error) {
            errors.push_back(fmt::format("platform {}: {}", name, error.what()));
        }
    }
    if (all.empty() && !errors.empty()) throw DeviceError(errors.front());
    for (const std::string& error : errors) warn("warning: " + error + "; its devices are left out");
    return all;
}

std::string unusable_reason(const DeviceInfo& device) {
    if (!device.available) return "not available";
    if (!device.compiler_available) return "without a compiler";
    return uses_il() && device.il_versions.empty() ? "unable to accept SPIR-V (--il)" : "";
}

DeviceInfo device_info(const cl::Device& device) {
    return guarded("querying the properties of a device", [&device] {
        const cl_device_fp_config floats = device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>();
        DeviceInfo info;
        info.name = device.getInfo<CL_DEVICE_NAME>();
        info.platform = cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>()).getInfo<CL_PLATFORM_NAME>();
        info.version = device.getInfo<CL_DEVICE_VERSION>();
        info.driver = device.getInfo<CL_DRIVER_VERSION>();
        info.type = type_name(device.getInfo<CL_DEVICE_TYPE>());
        info.pci_address = pci_address_of(device);
        info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
        info.local_memory_bytes = device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
        info.local_memory_is_dedicated = device.getInfo<CL_DEVICE_LOCAL_MEM_TYPE>() == CL_LOCAL;
        info.global_memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
        info.separate_memory = info.type != "cpu" && device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>() == CL_FALSE;
        info.max_allocation_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
        info.max_group_size = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
        info.ends_loops_early = info.name.find("llvmpipe") != std::string::npos;
        info.native_float_width = device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>();
        info.correctly_rounded_divide_sqrt = (floats & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
        info.fused_multiply_add = (floats & CL_FP_FMA) != 0;
        info.denormals = (floats & CL_FP_DENORM) != 0;
        info.profiling = (device.getInfo<CL_DEVICE_QUEUE_PROPERTIES>() & CL_QUEUE_PROFILING_ENABLE) != 0;
        info.il_versions = il_versions(device);
        info.available = device.getInfo<CL_DEVICE_AVAILABLE>() == CL_TRUE;
        info.compiler_available = device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() == CL_TRUE;
        return info;
    });
}

std::size_t device_index(const std::string& wanted, const std::vector<DeviceInfo>& devices, std::size_t ordinal) {
    if (devices.empty()) {
        const std::string limit = memory_limit();
        throw DeviceError(
            fmt::format("no OpenCL device found; remedy: {}install a driver (Debian: apt install pocl-opencl-icd), "
                        "look at the output "
                        "of clinfo, or unset the environment variable OCL_ICD_VENDORS if it hides the driver",
                        limit.empty() ? "" : fmt::format("raise {}, which may be too low for a driver, ", limit)));
    }
    const std::vector<std::string> entries = split(wanted, ',');
    const std::string& entry = entries[ordinal % entries.size()];
    if (entry.empty()) return default_index(devices, ordinal);
    const std::size_t found = named_index(entry, devices);
    if (found == devices.size())
        throw DeviceError(fmt::format(
            "no OpenCL device matches '{}'; remedy: give a number, a type or a part of a name or version from:{}",
            entry, device_list(devices)));
    if (const std::string reason = unusable_reason(devices[found]); !reason.empty())
        throw DeviceError(fmt::format("OpenCL device {} is {}; remedy: choose another device from:{}",
                                      full_name(devices[found]), reason, device_list(devices)));
    return found;
}

cl::Device choose_device(const std::string& wanted, std::size_t ordinal) {
    const std::vector<cl::Device> devices = all_devices();
    if (devices.empty())
        if (const std::string problem = driver_cache_problem(); !problem.empty()) throw DeviceError(problem);
    std::vector<DeviceInfo> infos;
    for (const cl::Device& device : devices) infos.push_back(device_info(device));
    const std::string selector = wanted.empty() ? environment_value("RAYA_DEVICE") : wanted;
    const std::size_t index = device_index(selector, infos, ordinal);
    log_message(kVerbose, fmt::format("device {}: {} ({}, {}, driver {})", index, infos[index].name,
                                      infos[index].platform, infos[index].version, infos[index].driver));
    return devices[index];
}

}  // namespace raya
