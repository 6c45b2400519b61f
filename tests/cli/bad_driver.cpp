// An OpenCL driver with one platform and one device, for tests of what raya does with drivers that misbehave.
//   RAYA_BAD_DRIVER="hang platforms"     the call hangs that looks for platforms; also "devices" and "info"
//   RAYA_BAD_DRIVER="crash platforms"    ... raises SIGSEGV
//   RAYA_BAD_DRIVER="fail devices"       ... returns CL_OUT_OF_HOST_MEMORY
#include <CL/cl_icd.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>

struct _cl_platform_id {  // NOLINT(bugprone-reserved-identifier): OpenCL's name
    _cl_icd_dispatch* dispatch;
};
struct _cl_device_id {  // NOLINT(bugprone-reserved-identifier)
    _cl_icd_dispatch* dispatch;
};

namespace {

_cl_icd_dispatch functions{};
_cl_platform_id platform{&functions};
_cl_device_id device{&functions};

cl_int misbehave(const std::string& call) {
    const char* const variable = std::getenv("RAYA_BAD_DRIVER");
    const std::string fault = variable == nullptr ? "" : variable;
    if (fault == "crash " + call) std::raise(SIGSEGV);
    while (fault == "hang " + call) ::sleep(1);
    return fault == "fail " + call ? CL_OUT_OF_HOST_MEMORY : CL_SUCCESS;
}

template <class Value>
cl_int answer(const Value& value, size_t bytes, size_t capacity, void* to, size_t* needed) {
    if (to != nullptr && capacity >= bytes) std::memcpy(to, &value, bytes);
    if (needed != nullptr) *needed = bytes;
    return CL_SUCCESS;
}

cl_int CL_API_CALL platform_info(cl_platform_id, cl_platform_info query, size_t size, void* value, size_t* needed) {
    const std::string text = query == CL_PLATFORM_EXTENSIONS       ? "cl_khr_icd"
                             : query == CL_PLATFORM_ICD_SUFFIX_KHR ? "BAD"
                             : query == CL_PLATFORM_VERSION        ? "OpenCL 1.2 bad"
                                                                   : "Bad driver";
    return answer(*text.c_str(), text.size() + 1, size, value, needed);
}

cl_int CL_API_CALL device_ids(cl_platform_id, cl_device_type, cl_uint capacity, cl_device_id* to, cl_uint* count) {
    if (const cl_int error = misbehave("devices"); error != CL_SUCCESS) return error;
    if (capacity > 0 && to != nullptr) *to = &device;
    if (count != nullptr) *count = 1;
    return CL_SUCCESS;
}

cl_int CL_API_CALL device_info(cl_device_id, cl_device_info query, size_t size, void* value, size_t* needed) {
    if (const cl_int error = misbehave("info"); error != CL_SUCCESS) return error;
    if (query == CL_DEVICE_PLATFORM) {
        const cl_platform_id own = &platform;
        return answer(own, sizeof own, size, value, needed);
    }
    if (query == CL_DEVICE_NAME || query == CL_DEVICE_VERSION || query == CL_DRIVER_VERSION)
        return answer("bad", 4, size, value, needed);
    return answer(cl_ulong{0}, size != 0 ? size : 4, size, value, needed);
}

cl_int CL_API_CALL platform_ids(cl_uint capacity, cl_platform_id* to, cl_uint* count) {
    if (const cl_int error = misbehave("platforms"); error != CL_SUCCESS) return error;
    functions.clGetPlatformInfo = platform_info;
    functions.clGetDeviceIDs = device_ids;
    functions.clGetDeviceInfo = device_info;
    functions.clRetainDevice = functions.clReleaseDevice = [](cl_device_id) -> cl_int { return CL_SUCCESS; };
    if (capacity > 0 && to != nullptr) *to = &platform;
    if (count != nullptr) *count = 1;
    return CL_SUCCESS;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void* CL_API_CALL clGetExtensionFunctionAddress(const char* name) {
    return std::strcmp(name, "clIcdGetPlatformIDsKHR") == 0 ? reinterpret_cast<void*>(platform_ids)
           : std::strcmp(name, "clGetPlatformInfo") == 0    ? reinterpret_cast<void*>(platform_info)
                                                            : nullptr;
}

extern "C" __attribute__((visibility("default"))) cl_int CL_API_CALL clGetPlatformInfo(cl_platform_id p,
                                                                                       cl_platform_info query,
                                                                                       size_t size, void* value,
                                                                                       size_t* needed) {
    return platform_info(p, query, size, value, needed);
}
