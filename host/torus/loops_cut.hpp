// A device that has ended a kernel's loops early (kernels/shared/loop_canary.clh).
#pragma once
#include <string>

#include "host/error.hpp"

namespace raya {

/// `label`: of the step. `remedy`: what gives loops less to do.
inline DeviceError loops_cut(const std::string& label, const std::string& device, const std::string& remedy) {
    return DeviceError("'" + label + "': " + device +
                       " has ended loops early and said nothing, so the image would be wrong; remedy: " + remedy +
                       ", or another device");
}

}  // namespace raya
