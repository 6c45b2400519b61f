#include "host/cl/capture.hpp"

#include <fmt/core.h>

#include <regex>

#include "host/base/encoding.hpp"
#include "host/base/whole_file.hpp"

namespace raya {
namespace {

Capture* active_capture = nullptr;

constexpr cl_uchar kInitialByte = 0xcd;  // contents of new buffers

std::string bytes_of(const cl::CommandQueue& queue, cl_mem buffer, std::size_t bytes) {
    std::string contents(bytes, '\0');
    const cl_int code = clEnqueueReadBuffer(queue(), buffer, CL_TRUE, 0, bytes, contents.data(), 0, nullptr, nullptr);
    if (code != CL_SUCCESS) throw cl::Error(code, "clEnqueueReadBuffer");
    return contents;
}

// Returns "arg2_node_memories" for argument 2 and buffer "node memories".
std::string file_name(std::size_t index, const std::string& buffer) {
    return std::regex_replace(fmt::format("arg{}_{}", index, buffer), std::regex("[^A-Za-z0-9]"), "_");
}

}  // namespace

Capture::Capture(std::size_t step, std::filesystem::path folder, std::function<void(const Json&)> report)
    : captured_step_(step), folder_(std::move(folder)), report_(std::move(report)) {
    active_capture = this;
}

Capture::~Capture() { active_capture = nullptr; }

Capture* Capture::active() { return active_capture; }

void Capture::start_step(const std::string& name) const { report_({{"step", step_}, {"name", name}}); }

void Capture::write_file(const std::string& name, const std::string& bytes) const {
    if (step_ == captured_step_) write_whole_file(folder_ / name, bytes);
}

void Capture::build_begins(const std::string& name, const std::string& source, const std::string& options) {
    ++step_;
    building_ = {name, source, options};
    launched_.clear();
    write_file("kernel.cl", source);
    write_file("launch.json", Json{{"program", name}, {"options", options}}.dump(4));
    start_step("build of " + name);
}

void Capture::build_ended(const cl::Program& program, const std::string&, const std::string&, double) {
    programs_[program()] = std::move(building_);
    report_({{"done", step_}, {"outputs", Json::object()}});
}

void Capture::add_buffer(const cl::CommandQueue& queue, const cl::Buffer& buffer, const std::string& name,
                         std::size_t bytes) {
    buffers_[buffer()] = {name, bytes};
    clEnqueueFillBuffer(queue(), buffer(), &kInitialByte, 1, 0, bytes, 0, nullptr, nullptr);
}

void Capture::set_argument(const cl::Kernel& kernel, std::size_t index, std::size_t bytes, const void* value) {
    std::string text = value != nullptr ? std::string(static_cast<const char*>(value), bytes) : std::string();
    set_arguments_[kernel()][index] = {bytes, std::move(text)};
}

std::vector<Capture::Argument> Capture::arguments_of(cl_kernel kernel) const {
    std::vector<Argument> arguments;
    for (const auto& [index, argument] : set_arguments_.at(kernel)) {
        const auto& [bytes, value] = argument;
        const auto found = value.size() == sizeof(cl_mem)
                               ? buffers_.find(*reinterpret_cast<const cl_mem*>(value.data()))
                               : buffers_.end();
        if (found != buffers_.end())
            arguments.push_back({file_name(index, found->second.name), found->second.bytes, found->first});
        else
            arguments.push_back({file_name(index, value.empty() ? "local" : "value"), bytes, nullptr, value});
    }
    return arguments;
}

void Capture::launch_begins(const cl::CommandQueue& queue, const cl::Kernel& kernel, const CommandRecord& launch) {
    ++step_;
    launched_ = arguments_of(kernel());
    queue.finish();
    if (step_ == captured_step_) {
        const ProgramText& program = programs_.at(kernel.getInfo<CL_KERNEL_PROGRAM>()());
        write_file("kernel.cl", program.source);
        Json arguments = Json::array();
        for (const Argument& a : launched_) {
            const char* const kind = a.buffer != nullptr ? "buffer" : a.value.empty() ? "local" : "value";
            arguments.push_back({{"name", a.name}, {"kind", kind}, {"bytes", a.bytes}});
            if (a.buffer != nullptr) write_file(a.name + ".in", bytes_of(queue, a.buffer, a.bytes));
            if (!a.value.empty()) write_file(a.name + ".in", a.value);
        }
        write_file("launch.json", Json{{"program", program.name},
                                       {"kernel", launch.target_name},
                                       {"options", program.options},
                                       {"groups", launch.groups},
                                       {"group_size", launch.group_size},
                                       {"arguments", arguments}}
                                      .dump(4));
    }
    start_step("launch of " + launch.target_name);
}

void Capture::launch_ended(const cl::CommandQueue& queue, const cl::Kernel&, CommandRecord&) {
    queue.finish();
    Json outputs = Json::object();
    for (const Argument& a : launched_) {
        if (a.buffer == nullptr) continue;
        const std::string bytes = bytes_of(queue, a.buffer, a.bytes);
        outputs[a.name] = bytes_hash(bytes);
        write_file(a.name + ".out", bytes);
    }
    report_({{"done", step_}, {"outputs", outputs}});
}

void Capture::expect(const std::string& buffer, const KnownWords& known) {
    for (const Argument& a : launched_) {
        const auto found = buffers_.find(a.buffer);
        if (found == buffers_.end() || found->second.name != buffer || a.bytes != 4 * known.words.size()) continue;
        write_file(a.name + ".expected", {reinterpret_cast<const char*>(known.words.data()), a.bytes});
        write_file(a.name + ".mask", {reinterpret_cast<const char*>(known.mask.data()), a.bytes});
        report_({{"expected", step_}});
    }
}

void report_expected(const std::string& buffer, const KnownWords& known) {
    if (Capture::active() != nullptr) Capture::active()->expect(buffer, known);
}

}  // namespace raya
