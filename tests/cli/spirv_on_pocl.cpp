// Makes PoCL 3.1 accept SPIR-V: a library that is preloaded into raya (LD_PRELOAD). PoCL 3.1 accepts LLVM bitcode for
// the target SPIR, so this library translates SPIR-V to such bitcode with llvm-spirv.
//   RAYA_SPIRV_FAULT="129 131"      replaces all instructions with opcode 129 (OpFAdd) by opcode 131 (OpFSub)
#include <CL/cl.h>
#include <CL/cl_ext.h>
#include <dlfcn.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "host/base/child_process.hpp"

namespace {

template <class Function>
Function* driver_function(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

void inject_fault(std::vector<std::uint32_t>& module) {
    const char* const fault = std::getenv("RAYA_SPIRV_FAULT");
    std::uint32_t opcode = 0, other = 0;
    if (fault == nullptr || !(std::istringstream(fault) >> opcode >> other)) return;
    constexpr std::size_t kHeaderWords = 5;
    for (std::size_t at = kHeaderWords; at < module.size(); at += module[at] >> 16)
        if ((module[at] & 0xffff) == opcode) module[at] = (module[at] & 0xffff0000) | other;
}

/// Returns the LLVM bitcode of a SPIR-V module; empty on failure.
std::string bitcode_of(const std::vector<std::uint32_t>& module) {
    const raya::TemporaryFolder folder("raya-spirv");
    const std::string spirv = folder / "module.spv", bitcode = folder / "module.bc";
    std::ofstream(spirv).write(reinterpret_cast<const char*>(module.data()), std::streamsize(module.size() * 4));
    std::string bytes;
    if (std::system(("llvm-spirv-" RAYA_LLVM " -r " + spirv + " -o " + bitcode).c_str()) == 0) {
        std::ifstream file(bitcode);
        bytes.assign(std::istreambuf_iterator<char>(file), {});
    }
    return bytes;
}

cl_program CL_API_CALL create_program(cl_context context, const void* il, size_t size, cl_int* error) {
    std::vector<std::uint32_t> module(size / 4);
    std::memcpy(module.data(), il, module.size() * 4);
    inject_fault(module);
    const std::string bitcode = bitcode_of(module);
    cl_device_id device = nullptr;
    clGetContextInfo(context, CL_CONTEXT_DEVICES, sizeof(cl_device_id), &device, nullptr);
    const size_t bytes = bitcode.size();
    const auto* data = reinterpret_cast<const unsigned char*>(bitcode.data());
    return clCreateProgramWithBinary(context, 1, &device, &bytes, &data, nullptr, error);
}

}  // namespace

extern "C" {

cl_int CL_API_CALL clGetDeviceInfo(cl_device_id device, cl_device_info query, size_t size, void* value,
                                   size_t* needed_bytes) {
    static constexpr char kVersions[] = "SPIR-V_1.0";
    if (query != CL_DEVICE_IL_VERSION_KHR)
        return driver_function<decltype(clGetDeviceInfo)>("clGetDeviceInfo")(device, query, size, value, needed_bytes);
    if (value != nullptr) std::memcpy(value, kVersions, std::min(size, sizeof kVersions));
    if (needed_bytes != nullptr) *needed_bytes = sizeof kVersions;
    return CL_SUCCESS;
}

void* CL_API_CALL clGetExtensionFunctionAddressForPlatform(cl_platform_id, const char* name) {
    return std::strcmp(name, "clCreateProgramWithILKHR") == 0 ? reinterpret_cast<void*>(create_program) : nullptr;
}

cl_int CL_API_CALL clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                                  void(CL_CALLBACK* notify)(cl_program, void*), void* user) {
    size_t source_bytes = 0;
    clGetProgramInfo(program, CL_PROGRAM_SOURCE, 0, nullptr, &source_bytes);
    const std::string spir_options = std::string(options) + " -x spir -spir-std=1.2";
    return driver_function<decltype(clBuildProgram)>("clBuildProgram")(
        program, count, devices, source_bytes > 1 ? options : spir_options.c_str(), notify, user);
}

}  // extern "C"
