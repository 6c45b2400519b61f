// Exceptions that end a command, and the exit codes for them.
#pragma once
#include <stdexcept>
#include <string>

namespace raya {

inline constexpr int kExitOk = 0;
inline constexpr int kExitUserError = 2;    // bad input, bad option, a scene that does not fit
inline constexpr int kExitDeviceError = 3;  // no device, a failed kernel build, a failed OpenCL call

/// An error that the user can fix. The message gives the cause, its place and the remedy.
struct UserError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A failure of the device, its driver or its compiler. The message gives the OpenCL call, its error, the kernel, the
/// build options and the remedy.
struct DeviceError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace raya
