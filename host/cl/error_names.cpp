#include "host/cl/error_names.hpp"

#include <fmt/core.h>

#include <map>
#include <sstream>
#include <string_view>

namespace raya {
namespace {

// Names without CL_ of the codes -1, -2, ... and -30, -31, ... No CL_ macros, because the OpenCL 1.2 headers do not
// define the codes of later versions, which drivers may return.
constexpr std::string_view kNamesFrom1 =
    "DEVICE_NOT_FOUND DEVICE_NOT_AVAILABLE COMPILER_NOT_AVAILABLE MEM_OBJECT_ALLOCATION_FAILURE OUT_OF_RESOURCES "
    "OUT_OF_HOST_MEMORY PROFILING_INFO_NOT_AVAILABLE MEM_COPY_OVERLAP IMAGE_FORMAT_MISMATCH "
    "IMAGE_FORMAT_NOT_SUPPORTED BUILD_PROGRAM_FAILURE MAP_FAILURE MISALIGNED_SUB_BUFFER_OFFSET "
    "EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST COMPILE_PROGRAM_FAILURE LINKER_NOT_AVAILABLE LINK_PROGRAM_FAILURE "
    "DEVICE_PARTITION_FAILED KERNEL_ARG_INFO_NOT_AVAILABLE";
constexpr std::string_view kNamesFrom30 =
    "INVALID_VALUE INVALID_DEVICE_TYPE INVALID_PLATFORM INVALID_DEVICE INVALID_CONTEXT INVALID_QUEUE_PROPERTIES "
    "INVALID_COMMAND_QUEUE INVALID_HOST_PTR INVALID_MEM_OBJECT INVALID_IMAGE_FORMAT_DESCRIPTOR INVALID_IMAGE_SIZE "
    "INVALID_SAMPLER INVALID_BINARY INVALID_BUILD_OPTIONS INVALID_PROGRAM INVALID_PROGRAM_EXECUTABLE "
    "INVALID_KERNEL_NAME INVALID_KERNEL_DEFINITION INVALID_KERNEL INVALID_ARG_INDEX INVALID_ARG_VALUE "
    "INVALID_ARG_SIZE INVALID_KERNEL_ARGS INVALID_WORK_DIMENSION INVALID_WORK_GROUP_SIZE INVALID_WORK_ITEM_SIZE "
    "INVALID_GLOBAL_OFFSET INVALID_EVENT_WAIT_LIST INVALID_EVENT INVALID_OPERATION INVALID_GL_OBJECT "
    "INVALID_BUFFER_SIZE INVALID_MIP_LEVEL INVALID_GLOBAL_WORK_SIZE INVALID_PROPERTY INVALID_IMAGE_DESCRIPTOR "
    "INVALID_COMPILER_OPTIONS INVALID_LINKER_OPTIONS INVALID_DEVICE_PARTITION_COUNT INVALID_PIPE_SIZE "
    "INVALID_DEVICE_QUEUE INVALID_SPEC_ID MAX_SIZE_RESTRICTION_EXCEEDED";

}  // namespace

std::string error_name(cl_int code) {
    if (code == 0) return "CL_SUCCESS";
    if (code == -1001) return "CL_PLATFORM_NOT_FOUND_KHR";
    if (code == -9999) return "NVIDIA error -9999 (illegal read or write by a kernel)";
    const bool is_first = code > -30;
    std::istringstream names{std::string(is_first ? kNamesFrom1 : kNamesFrom30)};
    std::string name;
    for (cl_int of = is_first ? -1 : -30; code < 0 && names >> name; --of)
        if (of == code) return "CL_" + name;
    return fmt::format("unknown OpenCL error {}", code);
}

std::string error_remedy(cl_int code) {
    constexpr const char* kNoDriver =
        "install an OpenCL driver (Debian: pocl-opencl-icd), unset OCL_ICD_VENDORS, see clinfo";
    constexpr const char* kDeviceMemory =
        "the device has too little memory or too few registers: use fewer pixels, smaller work-groups, or another "
        "device";
    constexpr const char* kArguments =
        "compare the host's argument list with the kernel's parameters: order, types, sizes";
    constexpr const char* kGroupSize =
        "use a work-group size that the device and the kernel allow (a kernel may require one)";
    static const std::map<cl_int, const char*> remedies = {
        {-1, kNoDriver},
        {-1001, kNoDriver},
        {-2, "another program may hold the device: see clinfo, or choose another device"},
        {-3, "the driver cannot compile kernels: choose another device"},
        {-4, kDeviceMemory},
        {-5, kDeviceMemory},
        {-6, "the host has too little memory: raise its limit (ulimit -v), or render fewer pixels"},
        {-8, "copy between two buffers, or between parts of one buffer that do not overlap"},
        {-11, "read the build log"},
        {-14, "an earlier command failed: run under oclgrind to see which command"},
        {-43, "the driver does not know one of the build options"},
        {-46, "the program has no kernel of this name: compare the host's name with the .cl file"},
        {-50, kArguments},
        {-51, kArguments},
        {-52, kArguments},
        {-54, kGroupSize},
        {-55, kGroupSize},
        {-61, "use a smaller buffer: fewer pixels or a smaller scene"},
        {-9999, "a kernel accessed memory outside of its buffers: run under oclgrind"}};
    const auto remedy = remedies.find(code);
    return remedy == remedies.end() ? "" : remedy->second;
}

DeviceError device_error(const std::string& call, cl_int code, const std::string& operation) {
    const std::string remedy = error_remedy(code);
    return DeviceError(fmt::format("{}: {} failed with {} ({}){}{}", operation, call, error_name(code), code,
                                   remedy.empty() ? "" : "; remedy: ", remedy));
}

}  // namespace raya
