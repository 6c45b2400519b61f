// Kernel source, built for one device; and kernels with their argument types: a call with other types does not
// compile, a kernel with another number of parameters is refused when it is looked up (Program::kernel).
#pragma once
#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/base/clock.hpp"
#include "host/cl/error_names.hpp"
#include "host/cl/memory.hpp"
#include "host/cl/opencl.hpp"
#include "host/cl/profile.hpp"

namespace raya {

/// A text as a template's argument.
template <std::size_t Size>
struct FixedText {
    // NOLINTNEXTLINE(google-explicit-constructor): a literal stands for it, as in Uint<"begin">
    consteval FixedText(const char (&from)[Size]) { std::copy_n(from, Size, text); }
    char text[Size]{};
};

/// A kernel's `const uint` parameter by its name, such as Uint<"begin">: another one does not compile in its place.
template <FixedText Name>
struct Uint {
    static constexpr const char* kName = Name.text;
    cl_uint value;
};

/// The parameter's name in the kernel's source; its number from 0 where the driver keeps no names.
std::string argument_name(const cl::Kernel& kernel, cl_uint index);

/// A kernel's argument, to be read: a buffer's name and size, bytes of local memory, a number.
template <class T>
std::string argument_text(const Buffer<T>& buffer) {
    return fmt::format("{}, {} x {} bytes", buffer.name(), buffer.size(), sizeof(T));
}

template <class T>
std::string argument_text(const LocalMemory<T>& local) {
    return fmt::format("local, {} bytes", local.bytes());
}

template <FixedText Name>
std::string argument_text(const Uint<Name>& number) {
    return fmt::format("{}", number.value);
}

template <class T>
std::string argument_text(const T& value) {
    if constexpr (std::is_arithmetic_v<T>)
        return fmt::format("{}", value);
    else if constexpr (std::is_enum_v<T>)
        return fmt::format("{}", static_cast<std::underlying_type_t<T>>(value));
    else
        return fmt::format("struct of {} bytes", sizeof(T));
}

/// Args, in the kernel's order: `const Buffer<T>&` for an input, `Buffer<T>&` for an output, LocalMemory<T> for
/// __local memory, Uint for a whole number, and plain values such as cl_float or an enum for the rest.
template <class... Args>
class Kernel {
  public:
    static constexpr std::size_t kArgumentCount = sizeof...(Args);

    Kernel(cl::Kernel kernel, std::string name) : kernel_(std::move(kernel)), name_(std::move(name)) {}

    const std::string& name() const { return name_; }
    const cl::Kernel& handle() const { return kernel_; }

    /// What a launch with these arguments is told, to be read: names, where the driver knows them, and values.
    std::vector<ArgumentText> argument_texts(const Args&... args) const {
        cl_uint index = 0;
        return {ArgumentText{argument_name(kernel_, index++), argument_text(args)}...};
    }

    /// Sets all arguments for the launches that follow; DeviceError names the kernel and the argument's number from 0.
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
        set_bytes(index, local.bytes(), nullptr);
    }

    template <class T>
    void set_argument(cl_uint index, const T& value) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T> && !std::is_same_v<T, bool>,
                      "OpenCL takes neither host pointers nor bool as kernel arguments");
        set_bytes(index, sizeof(T), &value);
    }

    void set_bytes(cl_uint index, std::size_t bytes, const void* value) {
        guarded(fmt::format("setting argument {} of kernel '{}' ({} bytes)", index, name_, bytes),
                [&] { return kernel_.setArg(index, bytes, value); });
    }

    cl::Kernel kernel_;
    std::string name_;
};

/// The bytes of __local memory that one kernel argument asks for: none, unless it is a LocalMemory.
template <class T>
std::size_t local_bytes_of(const T&) {
    return 0;
}

template <class T>
std::size_t local_bytes_of(const LocalMemory<T>& local) {
    return local.bytes();
}

/// What RAYA_BUILD_OPTIONS adds to the options of every program.
std::string user_build_options();

/// Appends what a build or a first launch took to the file that RAYA_KERNEL_LOG names, from `start` to now: a line
/// "seconds <tab> step <tab> name <tab> options". tools/kernel_builds adds them up.
void log_kernel_build(const char* step, const std::string& name, const std::string& options, Clock::time_point start);

/// Whether RAYA_KERNEL_LOG is set.
bool logs_kernel_builds();

/// What one program's build took, and the first launches of its kernels.
struct KernelBuild {
    cl::Program program;
    std::string name, options;  // its file; as the compiler saw them
    double build_s = 0, launch_s = 0;

    std::size_t binary_bytes() const;  // for which PoCL compiles every kernel of the program once more. DeviceError
};

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
    const cl::Program& handle() const { return program_; }

    /// Writes the binary where later runs find it (kernel_binaries.hpp), with the kernels that were launched; one that
    /// came from there stays. UserError, DeviceError.
    void keep_binary() const;

    /// The kernel `kernel_name`, which takes Args (see Kernel).
    /// DeviceError: no such kernel (lists those there are), or another number of parameters (names both numbers).
    template <class... Args>
    Kernel<Args...> kernel(const std::string& kernel_name) const {
        return Kernel<Args...>(checked_kernel(kernel_name, sizeof...(Args)), kernel_name);
    }

  private:
    cl::Kernel checked_kernel(const std::string& kernel_name, std::size_t argument_count) const;

    bool takes_binary(const cl::Context& context, const cl::Device& device, const std::string& source);

    cl::Program program_;
    std::string name_, options_, log_;
    std::filesystem::path binary_file_;  // empty: the program came from it
};

}  // namespace raya
