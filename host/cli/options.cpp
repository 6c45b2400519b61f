#include "host/cli/options.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/cl/program.hpp"
#include "host/cli/help.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/mesh/mesh_file.hpp"
#include "host/ranks/ranks.hpp"
#include "host/tune/store.hpp"

namespace raya {

void Warnings::add(const std::string& text) {
    warn("warning: " + text);
    texts_.push_back(text);
}

void add_strict_option(CLI::App& command, bool& strict) {
    const OptionGroup group(command, kFiles);
    command.add_flag(
        "--strict", strict,
        "Refuse a scene with facets that are degenerate or not planar, or with entities that NFF does not define or "
        "that raya does not use in meshes; without --strict, raya omits or triangulates such facets and skips such "
        "entities, with a warning");
}

SceneInput read_scene(const std::string& file, bool strict) {
    SceneInput input;
    const auto warn_of_remarks = [&] {
        for (const SceneRemark& remark : input.remarks) input.warnings.add(remark_text(input_name(file), remark));
    };
    try {
        input.scene = read_scene_file(file, strict ? nullptr : &input.remarks);
    } catch (const UserError&) {
        warn_of_remarks();  // the remarks may explain the error
        throw;
    }
    warn_of_remarks();
    log_message(
        kVerbose,
        fmt::format("{}: {}, {}, {} x {} pixels", input_name(file), counted(input.scene.object_count(), "object"),
                    counted(input.scene.lights.size(), "light"), input.scene.view.width, input.scene.view.height));
    return input;
}

void warn_of_build_options(Warnings& warnings) {
    static const std::set<std::string> harmless_options = {"--il",
                                                           "-cl-opt-disable",
                                                           "-cl-fp32-correctly-rounded-divide-sqrt",
                                                           "-cl-kernel-arg-info",
                                                           "-cl-uniform-work-group-size",
                                                           "-cl-nv-verbose",
                                                           "-g",
                                                           "-w",
                                                           "-Werror"};
    std::istringstream options(user_build_options());
    for (std::string option; options >> option;)
        if (!harmless_options.contains(option))
            warnings.add(fmt::format("RAYA_BUILD_OPTIONS: {} may change pixels and counts", option));
}

void warn_of_slow_search(const Scene& scene, bool accelerated, Warnings& warnings) {
    constexpr std::size_t kManyObjects = 100'000;
    if (accelerated || scene.object_count() < kManyObjects) return;
    warnings.add(fmt::format("{}: every ray is tested against {} objects; --accel bvh finds the same hits faster",
                             scene.name, scene.object_count()));
}

void warn_of_lost_objects(const Scene& scene, const LengthScale& scale, const NumberFormat& format,
                          Warnings& warnings) {
    if (scale.vanishing_count == 0) return;
    warnings.add(
        fmt::format("{}: {} spheres, cones or checkers are invisible: they are smaller than {:.3g}, the minimum of {} "
                    "in a scene with lengths up to {:.3g}; remedy: --format fp32",
                    scene.name, scale.vanishing_count, scale.min_visible, format_name(format), scale.largest_length));
}

void refuse_value(const std::string& option, const std::string& value, const char* reason, const std::string& help) {
    throw UserError(value.empty() ? fmt::format("{} {}; {}: {}", option, reason, option, help)
                                  : fmt::format("{} {}: {}; {}: {}", option, value, reason, option, help));
}

CLI::Option* in_range(CLI::Option* option, double min, double max, const char* unit) {
    return option->check([=](const std::string& text) {
        const double number = parsed_number<double>(text).value_or(0);
        if (number >= min && number <= max) return std::string();
        const std::string range = std::isinf(max) ? fmt::format("{} or more", min) : fmt::format("{}..{}", min, max);
        throw UserError(fmt::format("{} {}: must be {}{}{}", option->get_name(), text, range, *unit ? " " : "", unit));
    });
}

// CLI11 options have no notes, so that the text is stored as the description of an inactive validator.
CLI::Option* attach_note(CLI::Option* option, const char* name, const std::string& text) {
    try {
        option->get_validator(name)->description(text);
        return option;
    } catch (const CLI::OptionNotFound&) {
        return option->check(CLI::Validator(text).name(name).active(false));
    }
}

std::string note_of(const CLI::Option& option, const char* name) {
    try {
        CLI::Validator note = *const_cast<CLI::Option&>(option).get_validator(name);
        return note.active().get_description();
    } catch (const CLI::OptionNotFound&) {
        return "";
    }
}

void refuse_choice(const std::string& option, const std::string& text, const std::vector<std::string>& names) {
    const std::string legal =
        fmt::format("must be {} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
    throw UserError(text.empty() ? fmt::format("{} must not be empty: it {}", option, legal)
                                 : fmt::format("{} {}: {}", option, text, legal));
}

void add_tuned_option(CLI::App& command, bool& no_tuned) {
    const OptionGroup group(command, kKernels);
    command.add_flag("--no-tuned", no_tuned,
                     "Use the defaults, not the values that raya tune stored for this device and driver, like the "
                     "environment variable RAYA_TUNED=off; the image does not change");
}

ScopedTunedSource use_tuned(bool no_tuned, Warnings* warnings) {
    const auto warn = [warnings](const std::string& text) {
        Warnings local_warnings;
        (warnings ? *warnings : local_warnings).add(text);
    };
    return ScopedTunedSource(no_tuned ? TunedSource{} : stored_choices(warn));
}

namespace {

// Adds the options to a command and its subcommands.
void add_to(CLI::App& command, bool is_first_rank) {
    const OptionGroup group(command, kGeneralOptions);
    if (CLI::Option* help = command.get_option_no_throw("--help"); help != nullptr) help->group(kGeneralOptions);
    command.set_help_all_flag("--help-all", "Print the help of all options and exit")
        ->group(has_short_help(command) ? kGeneralOptions : "");
    const auto change = [is_first_rank](int sign) {
        return [=](std::int64_t count) {
            if (sign * verbosity() < 0) throw UserError("--quiet and --verbose: give one of them");
            if (is_first_rank || sign < 0) set_verbosity(verbosity() + sign * static_cast<int>(count));
        };
    };
    command.add_flag_function("-q,--quiet", change(-1), "Print no summary, no progress; twice: no warnings");
    command.add_flag_function("-v,--verbose", change(1), "Log steps on stderr; twice: also kernels' builds");
    for (CLI::App* subcommand : command.get_subcommands([](const CLI::App* c) { return !c->get_prefix_command(); }))
        add_to(*subcommand, is_first_rank);
}

}  // namespace

void add_verbosity_options(CLI::App& program, const Ranks& ranks) { add_to(program, ranks.is_first()); }

namespace {

namespace fs = std::filesystem;

constexpr const char* kFileUseNote = "file use";

// Registers the kernels in a folder as inputs.
void add_kernels(const NamedFile& folder) {
    constexpr std::string_view kKernels = "kernels/";
    check_kernel_folder({.folder = folder.file});
    for (const auto& [name, text] : embedded_files())
        if (name.starts_with(kKernels)) {
            const fs::path file = fs::path(folder.file) / name.substr(kKernels.size());
            register_input(file, folder.option + " " + file.string());
        }
}

// Refuses an output folder that contains an input of the command, because the command might overwrite the input.
// Ignores scenes, because no command writes scenes to an output folder.
void check_output_folder(const NamedFile& folder) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.file, error))
        if (entry.path().extension() != ".nff" && !is_mesh_file(entry.path()))
            promise_output(entry.path(), folder.option + " " + entry.path().string());
}

}  // namespace

CLI::Option* set_file_use(CLI::Option* option, FileUse use) {
    return attach_note(option, kFileUseNote, std::to_string(static_cast<int>(use)));
}

void add_kernel_source_options(CLI::App& command, std::string& folder) {
    add_file(command, FileUse::kKernelFolder, "--kernel-dir DIR", folder,
             "Read the kernels from this folder, for kernel development");
    command.add_flag_callback("--il", use_il,
                              "Compile the kernels to SPIR-V with clang and llvm-spirv, and give the driver SPIR-V "
                              "instead of source; like --il in RAYA_BUILD_OPTIONS; the image does not change");
}

FileUse file_use_of(const CLI::Option& option) {
    const std::string use = note_of(option, kFileUseNote);
    return use.empty() ? FileUse::kNone : static_cast<FileUse>(std::stoi(use));
}

void check_files(const CLI::App& command, const std::vector<NamedFile>& more_outputs) {
    forget_promised_outputs();  // of an earlier command in this process, or this command's own
    const auto for_each_file = [&](FileUse use, auto add) {
        for (const CLI::Option* option : command.get_options())
            if (option->count() > 0 && file_use_of(*option) == use)
                for (const std::string& file : option->results()) add(NamedFile{option->get_name(), file});
    };
    for_each_file(FileUse::kRead,
                  [](const NamedFile& input) { register_input(input.file, input.option + " " + input.file); });
    for_each_file(FileUse::kKernelFolder, add_kernels);
    for_each_file(FileUse::kWrittenFolder, check_output_folder);
    std::vector<NamedFile> outputs;
    for_each_file(FileUse::kWritten, [&](const NamedFile& output) { outputs.push_back(output); });
    outputs.insert(outputs.end(), more_outputs.begin(), more_outputs.end());
    for (const NamedFile& output : outputs) promise_output(output.file, output.option + " " + output.file);
    for (const NamedFile& output : outputs) check_writable(output.file);  // last, because it redirects stdout
}

}  // namespace raya
