#include "host/python/session.hpp"

#include <fmt/core.h>
#include <pthread.h>
#include <pybind11/stl.h>

#include <csignal>
#include <cstdio>
#include <utility>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {
namespace {

// Lists, tuples, numpy arrays.
bool is_sequence(const py::handle& value) {
    return PySequence_Check(value.ptr()) != 0 && !py::isinstance<py::str>(value) && !py::isinstance<py::bytes>(value);
}

std::string text_of(const std::string& option, const py::handle& value) {
    if (py::isinstance<py::bool_>(value))
        throw py::value_error(fmt::format("{}: the option takes a value, not True", option));
    if (!is_sequence(value)) return py::str(value);
    std::string text;
    for (const py::handle element : value) text += (text.empty() ? "" : ",") + text_of(option, element);
    return text;
}

bool holds_sequences(const py::handle& value) {
    if (!is_sequence(value)) return false;
    for (const py::handle element : value)
        if (is_sequence(element) || py::isinstance<py::str>(element)) return true;
    return false;
}

// Saves Python's signal handlers and restores them in the destructor, because OpenCL drivers replace them (the LLVM in
// PoCL does).
class SignalHandlers {
  public:
    SignalHandlers() {
        for (int signal = 1; signal < 32; ++signal) ::sigaction(signal, nullptr, &saved_handlers_[signal]);
    }
    ~SignalHandlers() {
        for (int signal = 1; signal < 32; ++signal) ::sigaction(signal, &saved_handlers_[signal], nullptr);
    }
    SignalHandlers(const SignalHandlers&) = delete;
    SignalHandlers& operator=(const SignalHandlers&) = delete;

  private:
    struct sigaction saved_handlers_[32]{};
};

// Calls choose_device() with a larger default stack size for new threads. PoCL creates its threads in this call and
// puts the private memory of a work-group on their stacks (host/cl/driver.cpp).
cl::Device choose_device_with_stacks(const std::string& name) {
    pthread_attr_t saved_attributes, large_stack;
    ::pthread_getattr_default_np(&saved_attributes);
    ::pthread_attr_init(&large_stack);
    ::pthread_attr_setstacksize(&large_stack, std::size_t{128} << 20);
    ::pthread_setattr_default_np(&large_stack);
    const auto restore = [](const pthread_attr_t* saved) { ::pthread_setattr_default_np(saved); };
    const std::unique_ptr<pthread_attr_t, decltype(restore)> end(&saved_attributes, restore);
    return choose_device(name);
}

RenderCommand parse_options(CLI::App& program, const py::dict& options) {
    RenderCommand command;
    CLI::App* render = program.add_subcommand("render");
    add_render_command_options(*render, command);
    render->callback([&] {
        refuse_options_of_other_machines(*render, machine_named(command.render.machine));
        for (CLI::Option* option : render->get_options())
            if (file_use_of(*option) == FileUse::kWritten && option->count() > 0 && option->as<std::string>() == "-")
                throw UserError(option->get_name() + " -: name a file; Result has the report and the images");
        check_files(*render);
        check_render(command);
    });
    parse_keywords(program, options, "render");
    return command;
}

// If the option `name` has the value True, removes the option from `options` and returns true. For `cost` and
// `packets`, True stores the arrays in the Result; any other value is the name of the file for the arrays.
bool pop_if_true(py::dict& options, const char* name) {
    if (!options.contains(name) || options[name].ptr() != Py_True) return false;
    options.attr("pop")(name);
    return true;
}

// Removes pixels=(stride, first), which is not an option of the command line, from `options` and returns its value.
PixelSubset pop_pixels(py::dict& options) {
    if (!options.contains("pixels")) return {};
    const auto [stride, first] = options.attr("pop")("pixels").cast<std::pair<std::uint32_t, std::uint32_t>>();
    if (stride == 0 || first >= stride) throw py::value_error("pixels: must be (stride, first), 0 <= first < stride");
    return {stride, first};
}

// Throws DeviceError in a process that was forked from the first one.
void check_process() {
    static const pid_t first = ::getpid();
    if (::getpid() != first)
        throw DeviceError(
            "OpenCL does not work in a process that was forked after raya had opened a device; remedy: start it with "
            "multiprocessing.get_context('spawn')");
}

}  // namespace

void parse_keywords(CLI::App& program, const py::dict& options, const std::string& command) {
    std::vector<std::string> arguments;
    if (!command.empty()) arguments.push_back(command);
    for (const auto& [key, value] : options) {
        std::string name = py::str(key);
        while (name.ends_with('_')) name.pop_back();  // from_ sets --from, because `from` is a Python keyword
        for (char& letter : name)
            if (letter == '_') letter = '-';
        const std::string option = "--" + name;
        if (value.is_none() || value.ptr() == Py_False) continue;
        if (value.ptr() == Py_True)
            arguments.push_back(option);
        else if (name == "light" && holds_sequences(value))
            for (const py::handle light : value) arguments.push_back(option + '=' + text_of(option, light));
        else
            arguments.push_back(option + '=' +
                                (name == "size" ? replaced(text_of(option, value), ",", "x") : text_of(option, value)));
    }
    parse_arguments(program, arguments);
}

void forbid_new(const py::object& type, const char* remedy) {
    type.attr("__new__") = py::module_::import("builtins")
                               .attr("staticmethod")(py::cpp_function(
                                   [remedy](const py::args&, const py::kwargs&) { throw py::type_error(remedy); }));
}

py::object python_of(const Json& json) { return py::module_::import("json").attr("loads")(json_dump(json)); }

CostImage cost_image_of(const py::array& cost) {
    const char type_kind = cost.dtype().kind();
    if (cost.ndim() != 2 || (type_kind != 'u' && type_kind != 'i'))
        throw py::value_error("cost: must be an integer array [height, width] of modelled cycles");
    if (type_kind == 'i' && cost.size() > 0 && cost.attr("min")().cast<std::int64_t>() < 0)
        throw py::value_error("cost: modelled cycles must not be negative");
    const py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast> array(cost);
    CostImage image{static_cast<std::uint32_t>(array.shape(1)), static_cast<std::uint32_t>(array.shape(0)), {}};
    image.cycles.assign(array.data(), array.data() + array.size());
    std::uint64_t sum = 0;  // of all PEs
    for (const std::uint64_t cycles : image.cycles)
        if (__builtin_add_overflow(sum, cycles, &sum)) throw py::value_error("cost: the sum is 2^64 or more");
    return image;
}

PythonSession::PythonSession(const std::string& device)
    : device_(choose_device_with_stacks(device)), session_(device_) {}

PythonSession& PythonSession::shared(const std::string& device) {
    // The map is never destroyed, because drivers may be unloaded before the program destroys static objects.
    static auto* const sessions = new std::map<std::string, PythonSession>;
    check_process();
    const SignalHandlers handlers;
    return sessions->try_emplace(device, device).first->second;
}

std::shared_ptr<Render> PythonSession::render(const Scene& scene, const py::dict& kwargs, const py::object& progress) {
    py::dict options(kwargs.attr("copy")());
    const bool stores_costs = pop_if_true(options, "cost"), stores_packets = pop_if_true(options, "packets");
    const PixelSubset pixels = pop_pixels(options);
    CLI::App program;
    RenderCommand command = parse_options(program, options);
    forget_promised_outputs();
    command.pixels = pixels;
    command.render.scene = scene.name;
    command.record_costs = stores_costs || !command.cost.empty();
    command.keep_packets = stores_packets;
    command.counts = true;
    command.prints = false;
    command.progress = [&progress](double fraction) {
        const py::gil_scoped_acquire gil;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress.is_none()) progress(fraction);
    };
    check_process();
    if (renderer_ == std::this_thread::get_id())
        throw UserError("render() in the progress function of a render of the same session; remedy: another Session");
    const py::gil_scoped_release no_gil;
    const std::lock_guard lock(mutex_);
    renderer_ = std::this_thread::get_id();
    const auto reset = [](std::atomic<std::thread::id>* renderer) { *renderer = std::thread::id(); };
    const std::unique_ptr<std::atomic<std::thread::id>, decltype(reset)> end(&renderer_, reset);
    const SignalHandlers handlers;
    RenderRun run(command, SceneInput{scene, {}, {}}, device_, session_);
    return std::make_shared<Render>(render_image(command, run).value());
}

}  // namespace raya
