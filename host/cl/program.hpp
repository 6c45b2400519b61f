// Programs built for one device, and kernels with typed arguments: a launch with arguments of other types does not
// compile, and Program::kernel() throws if the number of parameters differs.
#pragma once
#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/base/log.hpp"
#include "host/cl/capture.hpp"
#include "host/cl/error_names.hpp"
#include "host/cl/memory.hpp"
#include "host/cl/opencl.hpp"

namespace raya {

/// A string that can be a template argument.
template <std::size_t Size>
struct FixedText {
    // NOLINTNEXTLINE(google-explicit-constructor): converts a literal, as in Uint<"begin">
    consteval FixedText(const char (&literal)[Size]) { std::copy_n(literal, Size, text); }
    char text[Size]{};
};

/// The argument for a kernel's `const uint` parameter. Its type contains the parameter's name (Uint<"begin">), so that
/// passing the argument of another parameter does not compile.
template <FixedText Name>
struct Uint {
    cl_uint value;
};

/// A kernel. Args, in the kernel's order: `const Buffer<T>&` for an input, `Buffer<T>&` for an output, LocalMemory<T>
/// for __local memory, Uint for a `uint`, and plain values such as cl_float or an enum for the rest.
template <class... Args>
class Kernel {
  public:
    Kernel(cl::Kernel kernel, std::string name) : kernel_(std::move(kernel)), name_(std::move(name)) {}

    const std::string& name() const { return name_; }
    const cl::Kernel& handle() const { return kernel_; }

    /// Sets all arguments for the following launches. Throws DeviceError, with the kernel's name and the argument's
    /// index from 0, if the driver rejects an argument.
    void set_arguments(Args... args) {
        cl_uint index = 0;
        (set_argument(index++, args), ...);
    }

  private:
    template <class T>
    void set_argument(cl_uint index, const Buffer<T>& buffer) {
        set_bytes(index, sizeof(cl_mem), &buffer.memory()());
    }

    template <class T>
    void set_argument(cl_uint index, const LocalMemory<T>& local) {
        set_bytes(index, local.local_bytes(), nullptr);
    }

    template <class T>
    void set_argument(cl_uint index, const T& value) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T> && !std::is_same_v<T, bool>,
                      "OpenCL takes neither host pointers nor bool as kernel arguments");
        set_bytes(index, sizeof(T), &value);
    }

    void set_bytes(cl_uint index, std::size_t bytes, const void* value) {
        if (Capture::active() != nullptr) Capture::active()->set_argument(kernel_, index, bytes, value);
        guarded(fmt::format("setting argument {} of kernel '{}' ({} bytes)", index, name_, bytes),
                [&] { return kernel_.setArg(index, bytes, value); });
    }

    cl::Kernel kernel_;
    std::string name_;
};

/// Returns the number of bytes of local memory that a kernel argument requires: 0 unless it is a LocalMemory.
template <class T>
std::size_t local_bytes_of(const T& argument) {
    if constexpr (requires { argument.local_bytes(); }) return argument.local_bytes();
    return 0;
}

/// Returns the value of the environment variable RAYA_BUILD_OPTIONS, which is appended to the options of every program.
std::string user_build_options();

/// An OpenCL program with its build time and the time of the first launches of its kernels.
struct KernelBuild {
    cl::Program program;
    std::string name, options;         // name as in Program; options as passed to the compiler
    double build_s = 0, launch_s = 0;  // seconds of the build, and of the first launches
};

/// Records builds, and the first launch of each kernel with each group size, for which PoCL compiles the kernel.
class KernelBuilds final : public SessionObserver {
  public:
    /// `log`: null, or a file to which each time is appended as a line "seconds <tab> build or launch <tab> name <tab>
    /// options"; tools/kernel_builds sums these times.
    explicit KernelBuilds(const char* log = nullptr) : log_(log) {}

    void build_ended(const cl::Program& program, const std::string& name, const std::string& options,
                     double seconds) override;
    void launch_begins(const cl::CommandQueue& queue, const cl::Kernel& kernel, const CommandRecord& launch) override;
    void launch_ended(const cl::CommandQueue& queue, const cl::Kernel& kernel, CommandRecord& launch) override;

    std::vector<KernelBuild> all;

  private:
    void write_log(double seconds, const char* step, const std::string& name, const std::string& options) const;

    const char* log_;
    std::set<std::pair<cl_kernel, std::uint64_t>> launched_;  // (kernel, group size)
    bool is_first_ = false;                                   // of the current launch
    Clock::time_point start_;
};

/// A built OpenCL program, made by Session::build().
class Program {
  public:
    /// Builds `source` for `device` with `options`, joined by blanks; `name` is for messages. The option "--il" builds
    /// from SPIR-V (kernel_source.hpp). Throws DeviceError, with options, device and the whole build log, if the build
    /// fails.
    Program(const cl::Context& context, const cl::Device& device, std::string name, const std::string& source,
            const std::vector<std::string>& options);

    const std::string& name() const { return name_; }
    const std::string& options() const { return options_; }  // as passed to the compiler
    const std::string& log() const { return log_; }          // build log, with the compiler's warnings
    const cl::Program& handle() const { return program_; }

    /// Returns the kernel `kernel_name` with parameters Args (see Kernel). Throws DeviceError if there is no such
    /// kernel (with a list of kernels) or if the number of parameters differs (with both numbers).
    template <class... Args>
    Kernel<Args...> kernel(const std::string& kernel_name) const {
        return Kernel<Args...>(checked_kernel(kernel_name, sizeof...(Args)), kernel_name);
    }

  private:
    cl::Kernel checked_kernel(const std::string& kernel_name, std::size_t argument_count) const;

    cl::Program program_;
    std::string name_, options_, log_;
};

}  // namespace raya
