// A device that fails on demand: preloaded into raya (LD_PRELOAD), it lets one call of OpenCL return an error.
//   RAYA_FAULT="clCreateBuffer 3 -4"    the third clCreateBuffer, and all after it, return -4 and do nothing
//   RAYA_FAULT="new 1000000 0"          the host has no memory for objects of 1,000,000 bytes or more
// No driver can be made to run out of memory or to lose its device at a chosen moment.
#include <CL/cl.h>
#include <dlfcn.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <sstream>
#include <string>

namespace {

struct Fault {
    std::string call;
    int at = 0;  // 1: the first call; of new: bytes
    cl_int error = CL_SUCCESS;

    Fault() {
        const char* text = std::getenv("RAYA_FAULT");
        std::istringstream(text != nullptr ? text : "") >> call >> at >> error;
    }
};

const Fault& wanted() {
    static const Fault fault;
    return fault;
}

/// What the call must return in place of doing its work; CL_SUCCESS: its work.
cl_int fault_of(const char* call) {
    const Fault& fault = wanted();
    static std::atomic<int> calls{0};
    return fault.call == call && ++calls >= fault.at ? fault.error : CL_SUCCESS;
}

template <class Function>
Function* real(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// Calls the real one, or returns the error.
template <class Function, class... Args>
cl_int command(const char* name, Args... args) {
    const cl_int error = fault_of(name);
    return error != CL_SUCCESS ? error : real<Function>(name)(args...);
}

/// The same for calls that return an object and the error by a pointer.
template <class Function, class... Args>
auto object(const char* name, cl_int* error, Args... args) -> decltype(real<Function>(name)(args..., error)) {
    const cl_int fault = fault_of(name);
    if (fault == CL_SUCCESS) return real<Function>(name)(args..., error);
    if (error != nullptr) *error = fault;
    return nullptr;
}

}  // namespace

// A sanitizer has an allocator of its own.
#ifndef __SANITIZE_ADDRESS__
void* operator new(std::size_t bytes) {
    constexpr std::size_t kNeverFails = 1000;  // what the fault itself is read with
    if (bytes > kNeverFails && wanted().call == "new" && bytes >= static_cast<std::size_t>(wanted().at))
        throw std::bad_alloc();
    if (void* memory = std::malloc(bytes != 0 ? bytes : 1)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

extern "C" {

cl_context CL_API_CALL clCreateContext(const cl_context_properties* properties, cl_uint count,
                                       const cl_device_id* devices,
                                       void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*), void* user,
                                       cl_int* error) {
    return object<decltype(clCreateContext)>("clCreateContext", error, properties, count, devices, notify, user);
}

cl_mem CL_API_CALL clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error) {
    return object<decltype(clCreateBuffer)>("clCreateBuffer", error, context, flags, size, host);
}

cl_int CL_API_CALL clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                                          const size_t* offset, const size_t* global, const size_t* local,
                                          cl_uint waits, const cl_event* wait_list, cl_event* event) {
    return command<decltype(clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel", queue, kernel, dimensions, offset,
                                                     global, local, waits, wait_list, event);
}

cl_int CL_API_CALL clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                                       size_t size, void* to, cl_uint waits, const cl_event* wait_list,
                                       cl_event* event) {
    return command<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer", queue, buffer, blocking, offset, size, to,
                                                  waits, wait_list, event);
}

cl_int CL_API_CALL clFinish(cl_command_queue queue) { return command<decltype(clFinish)>("clFinish", queue); }

}  // extern "C"
