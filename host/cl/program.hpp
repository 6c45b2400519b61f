// Kernel source, built for one device.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "host/cl/kernel.hpp"
#include "host/cl/opencl.hpp"

namespace raya {

/// What RAYA_BUILD_OPTIONS adds to the options of every program.
std::string user_build_options();

/// A built program. Made by Session::build.
class Program {
  public:
    /// Builds `source` for `device` with `options` exactly as given, joined by blanks; `name` is for messages.
    /// DeviceError on any failure, with options, device and the whole build log.
    Program(const cl::Context& context, const cl::Device& device, std::string name, const std::string& source,
            const std::vector<std::string>& options);

    const std::string& name() const { return name_; }
    const std::string& options() const { return options_; }  // as the compiler saw them
    const std::string& log() const { return log_; }          // warnings of a build that succeeded

    /// Seconds that clBuildProgram took, by the host's clock. Not everything: PoCL compiles a kernel's body at its
    /// first launch for each work-group size, so launch once before timing, with the sizes to be timed.
    double build_seconds() const { return build_seconds_; }

    /// The kernel `kernel_name`, which takes Args (see Kernel).
    /// DeviceError: no such kernel (lists those there are), or another number of parameters (names both numbers).
    template <class... Args>
    Kernel<Args...> kernel(const std::string& kernel_name) const {
        return Kernel<Args...>(checked_kernel(kernel_name, sizeof...(Args)), kernel_name);
    }

  private:
    cl::Kernel checked_kernel(const std::string& kernel_name, std::size_t argument_count) const;

    cl::Program program_;
    std::string name_, options_, log_;
    double build_seconds_ = 0;
};

}  // namespace raya
