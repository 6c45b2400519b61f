#include "host/cl/kernel.hpp"

namespace raya {

std::string argument_name(const cl::Kernel& kernel, cl_uint index) {
    try {
        const std::string name = kernel.getArgInfo<CL_KERNEL_ARG_NAME>(index);
        if (!name.empty()) return name;
    } catch (const cl::Error&) {  // names are kept for programs built with -cl-kernel-arg-info; some drivers always do
    }
    return std::to_string(index);
}

}  // namespace raya
