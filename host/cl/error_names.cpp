#include "host/cl/error_names.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

namespace raya {
namespace {

struct ErrorName {
    cl_int code;
    const char* name;
};

// Numbers, not CL_ macros, because the OpenCL 1.2 headers do not define the codes of later versions, which drivers may
// return.
constexpr ErrorName kErrorNames[] = {
    {0, "CL_SUCCESS"},
    {-1, "CL_DEVICE_NOT_FOUND"},
    {-2, "CL_DEVICE_NOT_AVAILABLE"},
    {-3, "CL_COMPILER_NOT_AVAILABLE"},
    {-4, "CL_MEM_OBJECT_ALLOCATION_FAILURE"},
    {-5, "CL_OUT_OF_RESOURCES"},
    {-6, "CL_OUT_OF_HOST_MEMORY"},
    {-7, "CL_PROFILING_INFO_NOT_AVAILABLE"},
    {-8, "CL_MEM_COPY_OVERLAP"},
    {-9, "CL_IMAGE_FORMAT_MISMATCH"},
    {-10, "CL_IMAGE_FORMAT_NOT_SUPPORTED"},
    {-11, "CL_BUILD_PROGRAM_FAILURE"},
    {-12, "CL_MAP_FAILURE"},
    {-13, "CL_MISALIGNED_SUB_BUFFER_OFFSET"},
    {-14, "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST"},
    {-15, "CL_COMPILE_PROGRAM_FAILURE"},
    {-16, "CL_LINKER_NOT_AVAILABLE"},
    {-17, "CL_LINK_PROGRAM_FAILURE"},
    {-18, "CL_DEVICE_PARTITION_FAILED"},
    {-19, "CL_KERNEL_ARG_INFO_NOT_AVAILABLE"},
    {-30, "CL_INVALID_VALUE"},
    {-31, "CL_INVALID_DEVICE_TYPE"},
    {-32, "CL_INVALID_PLATFORM"},
    {-33, "CL_INVALID_DEVICE"},
    {-34, "CL_INVALID_CONTEXT"},
    {-35, "CL_INVALID_QUEUE_PROPERTIES"},
    {-36, "CL_INVALID_COMMAND_QUEUE"},
    {-37, "CL_INVALID_HOST_PTR"},
    {-38, "CL_INVALID_MEM_OBJECT"},
    {-39, "CL_INVALID_IMAGE_FORMAT_DESCRIPTOR"},
    {-40, "CL_INVALID_IMAGE_SIZE"},
    {-41, "CL_INVALID_SAMPLER"},
    {-42, "CL_INVALID_BINARY"},
    {-43, "CL_INVALID_BUILD_OPTIONS"},
    {-44, "CL_INVALID_PROGRAM"},
    {-45, "CL_INVALID_PROGRAM_EXECUTABLE"},
    {-46, "CL_INVALID_KERNEL_NAME"},
    {-47, "CL_INVALID_KERNEL_DEFINITION"},
    {-48, "CL_INVALID_KERNEL"},
    {-49, "CL_INVALID_ARG_INDEX"},
    {-50, "CL_INVALID_ARG_VALUE"},
    {-51, "CL_INVALID_ARG_SIZE"},
    {-52, "CL_INVALID_KERNEL_ARGS"},
    {-53, "CL_INVALID_WORK_DIMENSION"},
    {-54, "CL_INVALID_WORK_GROUP_SIZE"},
    {-55, "CL_INVALID_WORK_ITEM_SIZE"},
    {-56, "CL_INVALID_GLOBAL_OFFSET"},
    {-57, "CL_INVALID_EVENT_WAIT_LIST"},
    {-58, "CL_INVALID_EVENT"},
    {-59, "CL_INVALID_OPERATION"},
    {-60, "CL_INVALID_GL_OBJECT"},
    {-61, "CL_INVALID_BUFFER_SIZE"},
    {-62, "CL_INVALID_MIP_LEVEL"},
    {-63, "CL_INVALID_GLOBAL_WORK_SIZE"},
    {-64, "CL_INVALID_PROPERTY"},
    {-65, "CL_INVALID_IMAGE_DESCRIPTOR"},
    {-66, "CL_INVALID_COMPILER_OPTIONS"},
    {-67, "CL_INVALID_LINKER_OPTIONS"},
    {-68, "CL_INVALID_DEVICE_PARTITION_COUNT"},
    {-69, "CL_INVALID_PIPE_SIZE"},
    {-70, "CL_INVALID_DEVICE_QUEUE"},
    {-71, "CL_INVALID_SPEC_ID"},
    {-72, "CL_MAX_SIZE_RESTRICTION_EXCEEDED"},
    {-1001, "CL_PLATFORM_NOT_FOUND_KHR"},
    {-1057, "CL_DEVICE_PARTITION_FAILED_EXT"},
    {-1058, "CL_INVALID_PARTITION_COUNT_EXT"},
    {-1059, "CL_INVALID_PARTITION_NAME_EXT"},
    {-1108, "CL_COMMAND_TERMINATED_ITSELF_WITH_FAILURE_ARM"},
    {-1121, "CL_CONTEXT_TERMINATED_KHR"},
    {-9999, "NVIDIA error -9999 (illegal read or write by a kernel)"},
};

}  // namespace

std::string error_name(cl_int code) {
    const auto* found = std::find_if(std::begin(kErrorNames), std::end(kErrorNames),
                                     [code](const ErrorName& entry) { return entry.code == code; });
    return found != std::end(kErrorNames) ? found->name : fmt::format("unknown OpenCL error {}", code);
}

std::string error_remedy(cl_int code) {
    switch (code) {
        case -1:
        case -1001:
            return "install an OpenCL driver (Debian: pocl-opencl-icd), unset OCL_ICD_VENDORS, see clinfo";
        case -2:
            return "another program may hold the device: see clinfo, or choose another device";
        case -3:
            return "the driver cannot compile kernels: choose another device";
        case -4:
        case -5:
            return "the device has too little memory or too few registers: use fewer pixels, smaller work-groups, or "
                   "another device";
        case -6:
            return "the host has too little memory: raise its limit (ulimit -v), or render fewer pixels";
        case -8:
            return "copy between two buffers, or between parts of one buffer that do not overlap";
        case -11:
            return "read the build log";
        case -14:
            return "an earlier command failed: run under oclgrind to see which command";
        case -43:
            return "the driver does not know one of the build options";
        case -46:
            return "the program has no kernel of this name: compare the host's name with the .cl file";
        case -50:
        case -51:
        case -52:
            return "compare the host's argument list with the kernel's parameters: order, types, sizes";
        case -54:
        case -55:
            return "use a work-group size that the device and the kernel allow (a kernel may require one)";
        case -61:
            return "use a smaller buffer: fewer pixels or a smaller scene";
        case -9999:
            return "a kernel accessed memory outside of its buffers: run under oclgrind";
        default:
            return "";
    }
}

DeviceError device_error(const std::string& call, cl_int code, const std::string& operation) {
    const std::string remedy = error_remedy(code);
    return DeviceError(fmt::format("{}: {} failed with {} ({}){}{}", operation, call, error_name(code), code,
                                   remedy.empty() ? "" : "; remedy: ", remedy));
}

}  // namespace raya
