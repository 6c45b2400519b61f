// Choice of a device, its properties, and error texts. Without an OpenCL device these tests fail.
#include <catch2/catch.hpp>
#include <cctype>
#include <cstdlib>
#include <string>
#include <vector>

#include "host/cl/device.hpp"
#include "host/cl/error_names.hpp"
#include "host/cl/kernel_source.hpp"

using namespace raya;
using Catch::Contains;

namespace {

DeviceInfo device_info_of(const std::string& platform, const std::string& name, const std::string& type,
                          bool usable = true) {
    DeviceInfo info;
    info.platform = platform;
    info.name = name;
    info.type = type;
    info.available = true;
    info.compiler_available = usable;
    return info;
}

const std::vector<DeviceInfo> kDevices = {
    device_info_of("Broken", "Old GPU", "gpu", false),
    device_info_of("Portable Computing Language", "pthread-EPYC", "cpu"),
    device_info_of("Vendor", "Arc 770", "gpu"),
    device_info_of("Vendor", "Arc 380", "gpu"),
};

std::string error_message_of(const std::string& wanted, const std::vector<DeviceInfo>& devices) {
    try {
        device_index(wanted, devices);
    } catch (const DeviceError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace

TEST_CASE("there is an OpenCL device, and every device has valid properties", "[cl]") {
    const std::vector<cl::Device> devices = all_devices();
    REQUIRE_FALSE(devices.empty());
    for (const cl::Device& device : devices) {
        const DeviceInfo info = device_info(device);
        CAPTURE(info.platform, info.name);
        CHECK_FALSE(info.name.empty());
        CHECK_FALSE(info.platform.empty());
        CHECK_THAT(info.version, Contains("OpenCL"));
        CHECK((info.type == "cpu" || info.type == "gpu" || info.type == "other"));
        CHECK(info.compute_units >= 1);
        CHECK(info.max_group_size >= 1);
        CHECK(info.native_float_width >= 1);
        CHECK(info.max_allocation_bytes <= info.global_memory_bytes);
        // Minimum values that OpenCL 1.2 requires of the full profile.
        CHECK(info.local_memory_bytes >= 32 * 1024);
        CHECK(info.max_allocation_bytes >= 128 * 1024 * 1024);
        CHECK(info.profiling);
    }
}

TEST_CASE("an installed device is found by number and by any part of its name, ignoring case", "[cl]") {
    const std::vector<cl::Device> devices = all_devices();
    REQUIRE_FALSE(devices.empty());
    CHECK(choose_device("0")() == devices[0]());
    std::string part = device_info(devices[0]).name.substr(1);
    for (char& letter : part) letter = char(std::toupper(static_cast<unsigned char>(letter)));
    CHECK(device_info(choose_device(part)).name == device_info(devices[0]).name);
}

TEST_CASE("a device is chosen by number, type, or part of its name, version or driver, and in turn from a list",
          "[cl]") {
    std::vector<DeviceInfo> devices = kDevices;
    devices[1].version = "OpenCL 3.0 PoCL HSTR: skylake-avx512";
    devices[3].driver = "23.17";
    for (const auto& [wanted, index] : {std::pair{"", 2u},  // the first usable GPU, not the first device
                                        {"arc", 2},
                                        {"ARC 3", 3},
                                        {"language PTHREAD", 1},
                                        {"3", 3},
                                        {"380", 3},  // not a device number, so part of a name
                                        {"CPU", 1},
                                        {"gpu", 2},
                                        {"avx512", 1},
                                        {"23.17", 3}}) {
        CAPTURE(wanted);
        CHECK(device_index(wanted, devices) == index);
    }
    CHECK(device_index("", {kDevices[0], kDevices[1]}) == 1);
    CHECK(device_index("", {device_info_of("Vendor", "FPGA", "other")}) == 0);
    const std::vector<std::size_t> expected = {1, 3, 2, 1, 3};
    for (std::size_t turn = 0; turn < expected.size(); ++turn) {
        CHECK(device_index("cpu,Arc 380,2", devices, turn) == expected[turn]);
        CHECK(device_index("cpu", devices, turn) == 1);
        CHECK(device_index("", devices, turn) == 2 + turn % 2);  // both GPUs in turn
    }
    CHECK_THROWS_WITH(device_index("cpu,radeon", devices, 1), Contains("'radeon'") && !Contains("'cpu"));
    CHECK_THROWS_AS(device_index("other", devices), DeviceError);
}

TEST_CASE("a device that does not exist is refused with the list of devices", "[cl]") {
    const std::string text = error_message_of("Radeon", kDevices);
    CHECK_THAT(text, Contains("'Radeon'") && Contains("remedy"));
    CHECK_THAT(text, Contains("0: Broken Old GPU (gpu, not usable)") && Contains("3: Vendor Arc 380 (gpu)"));
    CHECK_THAT(error_message_of("old", kDevices), Contains("without a compiler") && Contains("2: Vendor Arc 770"));
    CHECK_THAT(error_message_of("", {kDevices[0]}), Contains("no available OpenCL device") && Contains("Old GPU"));
    CHECK_THAT(error_message_of("", {}),
               Contains("pocl-opencl-icd") && Contains("OCL_ICD_VENDORS") && Contains("clinfo"));

    REQUIRE_FALSE(all_devices().empty());
    const std::string real_name = device_info(all_devices()[0]).name;
    CHECK_THROWS_WITH(choose_device("no such device"), Contains("no such device") && Contains(real_name));
    CHECK_THROWS_AS(choose_device("no such device"), DeviceError);
}

TEST_CASE("with --il, only devices that accept SPIR-V are usable", "[cl]") {
    std::vector<DeviceInfo> devices = kDevices;
    devices[3].il_versions = "SPIR-V_1.0";
    CHECK(device_index("", devices) == 2);
    CHECK_FALSE(uses_il());
    use_il();
    CHECK(uses_il());
    CHECK(device_index("", devices) == 3);
    CHECK_THAT(error_message_of("770", devices), Contains("unable to accept SPIR-V (--il)"));
    CHECK_THAT(error_message_of("", kDevices), Contains("no available OpenCL device accepts SPIR-V"));
    ::unsetenv("RAYA_BUILD_OPTIONS");
    std::string options = "-DA=1 --il -cl-std=CL1.2";
    CHECK(remove_il_option(options));
    CHECK(options == "-DA=1 -cl-std=CL1.2");
    CHECK_FALSE(remove_il_option(options));
    CHECK(options == "-DA=1 -cl-std=CL1.2");
}

TEST_CASE("errors have names and remedies", "[cl]") {
    CHECK(error_name(CL_SUCCESS) == "CL_SUCCESS");
    CHECK(error_name(CL_INVALID_KERNEL_ARGS) == "CL_INVALID_KERNEL_ARGS");
    CHECK(error_name(CL_BUILD_PROGRAM_FAILURE) == "CL_BUILD_PROGRAM_FAILURE");
    CHECK(error_name(-1001) == "CL_PLATFORM_NOT_FOUND_KHR");
    CHECK(error_name(-72) == "CL_MAX_SIZE_RESTRICTION_EXCEEDED");
    CHECK_THAT(error_name(-4711), Contains("-4711"));
    CHECK_THAT(error_remedy(CL_DEVICE_NOT_FOUND), Contains("pocl-opencl-icd"));
    CHECK(error_remedy(CL_INVALID_EVENT).empty());

    const auto fail = [] { throw cl::Error(CL_INVALID_WORK_GROUP_SIZE, "clEnqueueNDRangeKernel"); };
    CHECK_THROWS_WITH(guarded("'trace': launching", fail),
                      Contains("'trace': launching") && Contains("clEnqueueNDRangeKernel") &&
                          Contains("CL_INVALID_WORK_GROUP_SIZE (-54)") && Contains("remedy: use a work-group size"));
    CHECK_THROWS_AS(guarded("", fail), DeviceError);
    CHECK(guarded("", [] { return 7; }) == 7);
}
