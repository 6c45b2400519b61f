// Fault injection into OpenCL: a library that is preloaded into raya (LD_PRELOAD) and changes one kind of call.
//   RAYA_FAULT="clCreateBuffer 3 -4"          the third clCreateBuffer and all later ones return -4 and do nothing
//   RAYA_FAULT="clEnqueueCopyBuffer 3 lost"   every third clEnqueueCopyBuffer completes without copying.
//                                             `lost` also works for clEnqueueCopyBufferRect.
//   RAYA_FAULT="clEnqueueCopyBuffer 3 crash"  the third call raises SIGSEGV
//   RAYA_FAULT="clEnqueueCopyBuffer 3 overflow"   the third call overflows the stack of its thread
//   RAYA_FAULT="clEnqueueCopyBuffer 3 exit"   the third call ends the program with exit code 1
//   RAYA_FAULT="clFinish 1 slow"              the first and all later calls take 2.5 seconds longer
//   RAYA_FAULT="clBuildProgram 0 fma(a,b,c)=(a*b+c)"  a compiler with a fault: it replaces the call of a function. With
//                                             1 instead of 0: only in builds without -cl-opt-disable
//   RAYA_FAULT="clGetDeviceInfo 4100 8"       the query 0x1004 (CL_DEVICE_MAX_WORK_GROUP_SIZE) returns 8
//   RAYA_FAULT="clGetDeviceInfo 16655 59"     the query 0x410F (CL_DEVICE_PCI_BUS_INFO_KHR) returns the domain 59
//   RAYA_FAULT="clGetKernelWorkGroupInfo 4528 8"  the query 0x11B0 (CL_KERNEL_WORK_GROUP_SIZE) returns 8
//   RAYA_FAULT="clGetProgramInfo 4453 crash"  the query 0x1165 raises SIGSEGV
//   RAYA_FAULT="clGetProgramInfo 4453 0"      the query 0x1165 (CL_PROGRAM_BINARY_SIZES) returns 0
//   RAYA_FAULT="new 1000000 0"                allocations by operator new of 1,000,000 bytes or more fail
#include <CL/cl.h>
#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>
#include <sstream>
#include <string>
#include <thread>

namespace {

struct Fault {
    std::string call;
    int number = 0;              // first failing call (from 1), period (`lost`), query, or minimum bytes (`new`)
    std::string action;          // "lost", "crash", "overflow", "exit", "slow" or empty
    cl_int result = CL_SUCCESS;  // returned by the failing call; or the answer to the query

    Fault() {
        const char* text = std::getenv("RAYA_FAULT");
        std::istringstream(text != nullptr ? text : "") >> call >> number >> action;
        result = std::atoi(action.c_str());
        if (result != CL_SUCCESS) action.clear();
    }
};

const Fault& injected_fault() {
    static const Fault fault;
    return fault;
}

/// Overflows the stack: recurses without end, with frames of 16 KB.
int overflow(int depth) {
    volatile char frame[16384];
    frame[0] = static_cast<char>(depth);
    return depth == 0 ? 0 : overflow(depth + 1) + frame[0];
}

/// Injects the fault into this call. Returns the error that the call must return without doing its work, or CL_SUCCESS
/// if the call must do its work.
cl_int inject_fault(const char* call) {
    const Fault& fault = injected_fault();
    static std::atomic<int> calls{0};
    if (fault.call != call || fault.action == "lost" || ++calls < fault.number) return CL_SUCCESS;
    if (fault.action == "crash") std::raise(SIGSEGV);
    if (fault.action == "overflow") std::_Exit(overflow(1));
    if (fault.action == "exit") std::_Exit(1);
    if (fault.action == "slow") std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    return fault.result;
}

/// Counts the copy. Returns true if `lost` is injected and must prevent this copy.
bool loses_copy(const char* call) {
    const Fault& fault = injected_fault();
    static std::atomic<int> calls{0};
    return fault.action == "lost" && fault.call == call && ++calls % fault.number == 0;
}

/// Returns true if the injected fault is a compiler that replaces calls of a function.
bool replaces_calls() {
    return injected_fault().call == "clBuildProgram" && injected_fault().action.find('=') != std::string::npos;
}

template <class Function>
Function* driver_function(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// Calls the driver's function `name`, or returns the injected error.
template <class Function, class... Args>
cl_int call_or_fail(const char* name, Args... args) {
    const cl_int error = inject_fault(name);
    return error != CL_SUCCESS ? error : driver_function<Function>(name)(args...);
}

/// Calls the driver's function `name`, which returns an object and stores its error in `*error`; or stores the injected
/// error there and returns null.
template <class Function, class... Args>
auto create_or_fail(const char* name, cl_int* error, Args... args)
    -> decltype(driver_function<Function>(name)(args..., error)) {
    const cl_int fault = inject_fault(name);
    if (fault == CL_SUCCESS) return driver_function<Function>(name)(args..., error);
    if (error != nullptr) *error = fault;
    return nullptr;
}

/// If the injected fault names this query, replaces the driver's answer and returns CL_SUCCESS; else returns `error`.
cl_int replace_answer(const char* call, cl_uint query, size_t size, void* value, cl_int error) {
    const Fault& fault = injected_fault();
    if (fault.call != call || static_cast<int>(query) != fault.number || value == nullptr) return error;
    const size_t answer = static_cast<size_t>(fault.result);
    std::memcpy(value, &answer, std::min(size, sizeof answer));
    return CL_SUCCESS;
}

/// Instead of a copy, enqueues a read of one byte, so that `event` completes and has profiling times. Discards the
/// byte.
cl_int command_without_copy(cl_command_queue queue, cl_mem from, cl_uint waits, const cl_event* wait_list,
                            cl_event* event) {
    static char discarded_byte;
    return driver_function<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer")(
        queue, from, CL_FALSE, 0, 1, &discarded_byte, waits, wait_list, event);
}

}  // namespace

// The address sanitizer has its own operator new.
#ifndef __SANITIZE_ADDRESS__
void* operator new(std::size_t bytes) {
    constexpr std::size_t kMinFailingBytes = 1000;  // excludes the allocations of `Fault` itself
    if (bytes > kMinFailingBytes && injected_fault().call == "new" &&
        bytes >= static_cast<std::size_t>(injected_fault().number))
        throw std::bad_alloc();
    if (void* memory = std::malloc(bytes != 0 ? bytes : 1)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

extern "C" {

cl_int CL_API_CALL clGetPlatformIDs(cl_uint capacity, cl_platform_id* platforms, cl_uint* count) {
    return call_or_fail<decltype(clGetPlatformIDs)>("clGetPlatformIDs", capacity, platforms, count);
}

cl_context CL_API_CALL clCreateContext(const cl_context_properties* properties, cl_uint count,
                                       const cl_device_id* devices,
                                       void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*), void* user,
                                       cl_int* error) {
    return create_or_fail<decltype(clCreateContext)>("clCreateContext", error, properties, count, devices, notify,
                                                     user);
}

cl_program CL_API_CALL clCreateProgramWithSource(cl_context context, cl_uint count, const char** texts,
                                                 const size_t* sizes, cl_int* error) {
    std::string define = injected_fault().action;
    if (!replaces_calls()) define = "RAYA_NO_FAULT=";
    define.replace(define.find('='), 1, " ");
    std::string source = "#ifdef RAYA_FAULT\n#define " + define + "\n#endif\n";
    for (cl_uint i = 0; i < count; ++i)
        source += sizes != nullptr && sizes[i] != 0 ? std::string(texts[i], sizes[i]) : std::string(texts[i]);
    const char* text = source.c_str();
    return driver_function<decltype(clCreateProgramWithSource)>("clCreateProgramWithSource")(context, 1, &text, nullptr,
                                                                                             error);
}

cl_int CL_API_CALL clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                                  void(CL_CALLBACK* notify)(cl_program, void*), void* user) {
    const Fault& fault = injected_fault();
    std::string all = options != nullptr ? options : "";
    if (replaces_calls() && (fault.number == 0 || all.find("-cl-opt-disable") == all.npos)) all += " -DRAYA_FAULT";
    if (!replaces_calls() && inject_fault("clBuildProgram") != CL_SUCCESS) return fault.result;
    return driver_function<decltype(clBuildProgram)>("clBuildProgram")(program, count, devices, all.c_str(), notify,
                                                                       user);
}

cl_mem CL_API_CALL clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error) {
    return create_or_fail<decltype(clCreateBuffer)>("clCreateBuffer", error, context, flags, size, host);
}

cl_int CL_API_CALL clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                                          const size_t* offset, const size_t* global, const size_t* local,
                                          cl_uint waits, const cl_event* wait_list, cl_event* event) {
    return call_or_fail<decltype(clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel", queue, kernel, dimensions, offset,
                                                          global, local, waits, wait_list, event);
}

cl_int CL_API_CALL clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                                       size_t size, void* to, cl_uint waits, const cl_event* wait_list,
                                       cl_event* event) {
    return call_or_fail<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer", queue, buffer, blocking, offset, size, to,
                                                       waits, wait_list, event);
}

cl_int CL_API_CALL clEnqueueCopyBuffer(cl_command_queue queue, cl_mem from, cl_mem to, size_t from_offset,
                                       size_t to_offset, size_t size, cl_uint waits, const cl_event* wait_list,
                                       cl_event* event) {
    if (loses_copy("clEnqueueCopyBuffer")) return command_without_copy(queue, from, waits, wait_list, event);
    return call_or_fail<decltype(clEnqueueCopyBuffer)>("clEnqueueCopyBuffer", queue, from, to, from_offset, to_offset,
                                                       size, waits, wait_list, event);
}

cl_int CL_API_CALL clEnqueueCopyBufferRect(cl_command_queue queue, cl_mem from, cl_mem to, const size_t* from_origin,
                                           const size_t* to_origin, const size_t* region, size_t from_row,
                                           size_t from_slice, size_t to_row, size_t to_slice, cl_uint waits,
                                           const cl_event* wait_list, cl_event* event) {
    if (loses_copy("clEnqueueCopyBufferRect")) return command_without_copy(queue, from, waits, wait_list, event);
    return call_or_fail<decltype(clEnqueueCopyBufferRect)>("clEnqueueCopyBufferRect", queue, from, to, from_origin,
                                                           to_origin, region, from_row, from_slice, to_row, to_slice,
                                                           waits, wait_list, event);
}

cl_int CL_API_CALL clGetDeviceInfo(cl_device_id device, cl_device_info query, size_t size, void* value,
                                   size_t* needed_bytes) {
    const cl_int error =
        driver_function<decltype(clGetDeviceInfo)>("clGetDeviceInfo")(device, query, size, value, needed_bytes);
    return replace_answer("clGetDeviceInfo", query, size, value, error);
}

cl_int CL_API_CALL clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info query,
                                            size_t size, void* value, size_t* needed_bytes) {
    const cl_int error = driver_function<decltype(clGetKernelWorkGroupInfo)>("clGetKernelWorkGroupInfo")(
        kernel, device, query, size, value, needed_bytes);
    return replace_answer("clGetKernelWorkGroupInfo", query, size, value, error);
}

cl_int CL_API_CALL clGetProgramInfo(cl_program program, cl_program_info query, size_t size, void* value,
                                    size_t* needed_bytes) {
    const Fault& fault = injected_fault();
    if (fault.call == "clGetProgramInfo" && fault.action == "crash" && static_cast<int>(query) == fault.number)
        std::raise(SIGSEGV);
    const cl_int error =
        driver_function<decltype(clGetProgramInfo)>("clGetProgramInfo")(program, query, size, value, needed_bytes);
    return replace_answer("clGetProgramInfo", query, size, value, error);
}

cl_int CL_API_CALL clFinish(cl_command_queue queue) { return call_or_fail<decltype(clFinish)>("clFinish", queue); }

}  // extern "C"
