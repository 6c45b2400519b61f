// The two ways in which raya refuses to go on. Each carries the exit code that main() returns.
#pragma once
#include <stdexcept>
#include <string>

namespace raya {

inline constexpr int kExitOk = 0;
inline constexpr int kExitUserError = 2;    // bad input, bad option, a scene that does not fit
inline constexpr int kExitDeviceError = 3;  // no device, a failed build, a failed call

/// Something that the user can mend: the message says what is wrong, where, and the remedy.
struct UserError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The device, its driver or its compiler failed: the message names call, error, kernel, options and remedy.
struct DeviceError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace raya
