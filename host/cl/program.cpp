#include "host/cl/program.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <fstream>

#include "host/base/encoding.hpp"
#include "host/cl/driver.hpp"
#include "host/cl/kernel_source.hpp"

namespace raya {
namespace {

std::string joined(const std::vector<std::string>& options) { return fmt::format("{}", fmt::join(options, " ")); }

std::string log_of(const cl::Program& program, const cl::Device& device) {
    try {
        return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    } catch (const cl::Error& error) {  // not thrown: the caller reports the error of the build
        return fmt::format("(no log from the driver: {})", error_name(error.err()));
    }
}

std::string name_of(const cl::Device& device) {
    const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
    return platform.getInfo<CL_PLATFORM_NAME>() + " " + device.getInfo<CL_DEVICE_NAME>();
}

std::string failure_text(const cl::Error& error, const std::string& operation, const std::string& log) {
    const std::string text = device_error(error.what(), error.err(), operation).what();
    if (log.find("error") != log.npos) return text;
    const std::string problem = driver_cache_problem();
    if (!problem.empty()) return operation + ": " + problem;
    return text + "; if the log gives no reason, name an empty folder in POCL_CACHE_DIR: PoCL's cache may be damaged";
}

}  // namespace

std::string user_build_options() { return environment_value("RAYA_BUILD_OPTIONS"); }

void KernelBuilds::write_log(double seconds, const char* step, const std::string& name,
                             const std::string& options) const {
    if (log_ == nullptr) return;
    std::ofstream(log_, std::ios::app) << fmt::format("{:.4f}\t{}\t{}\t{}\n", seconds, step, name, options)
                                       << std::flush;
}

void KernelBuilds::build_ended(const cl::Program& program, const std::string& name, const std::string& options,
                               double seconds) {
    all.push_back({program, name, options, seconds});
    write_log(seconds, "build", name, options);
}

void KernelBuilds::launch_begins(const cl::CommandQueue& queue, const cl::Kernel& kernel, const CommandRecord& launch) {
    is_first_ = launched_.emplace(kernel(), launch.group_size).second;
    if (is_first_) queue.finish();
    start_ = Clock::now();
}

void KernelBuilds::launch_ended(const cl::CommandQueue& queue, const cl::Kernel& kernel, CommandRecord& launch) {
    if (!is_first_) return;
    queue.finish();
    const double seconds = seconds_since(start_);
    const cl::Program program = kernel.getInfo<CL_KERNEL_PROGRAM>();
    for (KernelBuild& build : all)
        if (build.program() == program()) build.launch_s += seconds;
    if (log_ != nullptr)
        write_log(seconds, "launch", fmt::format("{}, groups of {}", launch.target_name, launch.group_size),
                  program.getBuildInfo<CL_PROGRAM_BUILD_OPTIONS>(queue.getInfo<CL_QUEUE_DEVICE>()));
}

Program::Program(const cl::Context& context, const cl::Device& device, std::string name, const std::string& source,
                 const std::vector<std::string>& options)
    : name_(std::move(name)), options_(joined(options)) {
    std::string driver_options = options_;
    const bool from_spirv = remove_il_option(driver_options);
    const std::string operation = fmt::format("building program '{}'", name_);
    const std::string device_name = guarded(operation, [&] {
        program_ = from_spirv ? spirv_program(context, device, source, driver_options, operation)
                              : cl::Program(context, source);
        return name_of(device);
    });
    try {
        const DriverCall call(operation.c_str());
        program_.build(device, driver_options.c_str());
    } catch (const cl::Error& error) {
        const std::string log = log_of(program_, device);
        throw DeviceError(fmt::format("{}\n  device: {}\n  options: {}\n  build log:\n{}",
                                      failure_text(error, operation, log), device_name, options_, log));
    } catch (...) {            // out of memory inside the driver
        program_() = nullptr;  // leaked: the driver holds the program's lock, so a release would deadlock
        throw;
    }
    log_ = log_of(program_, device);
}

cl::Kernel Program::checked_kernel(const std::string& kernel_name, std::size_t argument_count) const {
    const std::string kernels = guarded(fmt::format("listing the kernels of program '{}'", name_),
                                        [&] { return program_.getInfo<CL_PROGRAM_KERNEL_NAMES>(); });
    const std::string operation = fmt::format("kernel '{}' of program '{}' (kernels: {})", kernel_name, name_, kernels);
    return guarded(operation, [&] {
        cl::Kernel kernel(program_, kernel_name.c_str());
        const std::size_t expected = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
        if (expected != argument_count) {
            throw DeviceError(
                fmt::format("kernel '{}' of program '{}' has {} parameters, but the host passes {}; remedy: make the "
                            "list of types on the host and the kernel's parameters agree",
                            kernel_name, name_, expected, argument_count));
        }
        return kernel;
    });
}

}  // namespace raya
