// Options of a command. An option's value must be legal for the type of the variable that stores the value.
#pragma once
#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "host/cl/kernel_options.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace raya {

// Reading of the scene that the command line names, and warnings.

/// Prints each new warning on stderr and stores it for the report. Ignores repeated warnings.
class Warnings {
  public:
    void add(const std::string& text);
    const std::vector<std::string>& texts() const { return texts_; }

  private:
    std::vector<std::string> texts_;
};

/// Adds --strict, with which raya refuses contents that are not NFF or cannot be traced, instead of skipping or
/// changing these contents.
void add_strict_option(CLI::App& command, bool& strict);

/// Help of the argument SCENE.
inline constexpr const char* kSceneHelp =
    "Scene in NFF, the format of the SPD programs, or a mesh: .obj, .ply, .gltf, .glb, .stl; -: NFF from stdin";

struct SceneInput {
    Scene scene;
    std::vector<SceneRemark> remarks;  // contents of the file that were skipped or changed
    Warnings warnings;
};

/// Reads a scene from a file or stdin ("-"). Warns of skipped and changed contents. Throws UserError as
/// read_scene_file() does.
SceneInput read_scene(const std::string& file, bool strict);

/// Warns of options in the environment variable RAYA_BUILD_OPTIONS that may change pixels and counts.
void warn_of_build_options(Warnings& warnings);

/// Warns if every ray is tested against 100,000 objects or more, because no accelerator is used.
void warn_of_slow_search(const Scene& scene, bool accelerated, Warnings& warnings);

/// Warns if objects are too small to be visible in this format. The limit depends on the scene's largest length.
void warn_of_lost_objects(const Scene& scene, const LengthScale& scale, const NumberFormat& format, Warnings& warnings);

/// The type of one value of an option: `Value` without std::optional or std::vector around it.
template <class Value>
struct OptionValue {
    using Type = Value;
};
template <class Value>
struct OptionValue<std::optional<Value>> : OptionValue<Value> {};
template <class Value>
struct OptionValue<std::vector<Value>> : OptionValue<Value> {};

/// Throws UserError with the option, the value, the reason, and the option's help text.
[[noreturn]] void refuse_value(const std::string& option, const std::string& value, const char* reason,
                               const std::string& help);

/// Throws UserError for an empty value, and for a number that is malformed or out of the type's range. Without this
/// check, CLI11 would treat an empty value as missing, wrap negative numbers and truncate large ones.
template <class Value>
void check_value(const std::string& option, const std::string& text, const std::string& help) {
    if (text.empty()) refuse_value(option, text, "must not be empty", help);
    if constexpr (std::is_arithmetic_v<Value>) {
        Value value{};
        const char* const end = text.data() + text.size();
        const auto [read_to, error] = std::from_chars(text.data(), end, value);
        const char* const reason = std::is_integral_v<Value> ? "not a whole number" : "not a number";
        const bool is_negative = std::is_unsigned_v<Value> && text.size() > 1 && text[0] == '-' &&
                                 text.find_first_not_of("0123456789", 1) == std::string::npos;
        if (is_negative || error == std::errc::result_out_of_range) refuse_value(option, text, "out of range", help);
        if (error != std::errc{} || read_to != end) refuse_value(option, text, reason, help);
    }
}

// Headings above groups of options in help.
inline constexpr const char* kFiles = "Files";
inline constexpr const char* kImageGroup = "Image";
inline constexpr const char* kCamera = "Camera and light";
inline constexpr const char* kMachine = "Machine and mapping";
inline constexpr const char* kTorusMachine = "Torus machine";
inline constexpr const char* kKernels = "Kernels and device";
inline constexpr const char* kDiagnostics = "Diagnostics";

/// Sets the heading of all options that are added to the command during this object's lifetime.
class OptionGroup {
  public:
    OptionGroup(CLI::App& command, const std::string& heading)
        : defaults_(*command.option_defaults()), previous_heading_(defaults_.get_group()) {
        defaults_.group(heading);
    }
    OptionGroup(const OptionGroup&) = delete;
    OptionGroup& operator=(const OptionGroup&) = delete;
    ~OptionGroup() { defaults_.group(previous_heading_); }

    /// Sets the heading of the options that are added from now on.
    void next(const std::string& heading) { defaults_.group(heading); }

  private:
    CLI::OptionDefaults& defaults_;
    std::string previous_heading_;
};

/// Attaches `text` to an option under the name `name`. Help does not show the text. note_of() returns the text, or ""
/// if no text has this name.
CLI::Option* attach_note(CLI::Option* option, const char* name, const std::string& text);
std::string note_of(const CLI::Option& option, const char* name);

inline constexpr const char* kBriefNote = "brief";

/// Adds an option, checks its value with check_value() and stores it in `value`. `name`: "--size N|WxH", with the
/// placeholder of the value in help. `brief`: help of the option in the command's short help; empty: the option is only
/// in --help-all, if the command has options with such a text.
template <class Value>
CLI::Option* add_value(CLI::App& command, const std::string& name, Value& value, const std::string& help = "",
                       const std::string& brief = "") {
    const std::size_t blank = name.find(' ');
    CLI::Option* option = command.add_option(name.substr(0, blank), value, help)->type_name(name.substr(blank + 1));
    option->check([option](const std::string& text) {
        check_value<typename OptionValue<Value>::Type>(option->get_name(), text, option->get_description());
        return std::string();
    });
    return brief.empty() ? option : attach_note(option, kBriefNote, brief);
}

/// Refuses numbers outside min..max: "--samples 0: must be 1..1000". `unit`: of the number, for the message.
CLI::Option* in_range(CLI::Option* option, double min, double max = std::numeric_limits<double>::infinity(),
                      const char* unit = "");

/// The values of an option with their names.
template <class Value>
using Choices = std::vector<std::pair<std::string, Value>>;

/// Throws UserError "OPTION TEXT: must be A, B or C" with the names of the choices.
[[noreturn]] void refuse_choice(const std::string& option, const std::string& text,
                                const std::vector<std::string>& names);

/// Returns the value that `text` names. Throws UserError like refuse_choice().
template <class Value>
Value parse_choice(const std::string& option, const std::string& text, const Choices<Value>& choices) {
    std::vector<std::string> names;
    for (const auto& [name, value] : choices) {
        if (name == text) return value;
        names.push_back(name);
    }
    refuse_choice(option, text, names);
}

/// Adds an option whose values are `choices`. The help shows their names and, unless the variable is a std::optional
/// without value, the default.
template <class Variable, class Value>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Variable& value, const Choices<Value>& choices,
                        const std::string& help, const std::string& brief = "") {
    CLI::Option* option = command.add_option_function<std::string>(
        name, [&value, choices, name](const std::string& text) { value = parse_choice(name, text, choices); }, help);
    std::string names;
    for (const auto& [choice, choice_value] : choices) {
        names += (names.empty() ? "" : "|") + choice;
        if (value == choice_value) option->default_str(choice);
    }
    option->type_name(names);
    return brief.empty() ? option : attach_note(option, kBriefNote, brief);
}

// The option --no-tuned, and the use of the values that raya tune stored for a device.

void add_tuned_option(CLI::App& command, bool& no_tuned);

/// Returns an object during whose lifetime renders use the stored values or, with `no_tuned`, the defaults. Prints a
/// warning if the file of stored values is unusable, and adds it to `warnings` unless `warnings` is null. `warnings`
/// must outlive the result.
ScopedTunedSource use_tuned(bool no_tuned, Warnings* warnings = nullptr);

// The options --quiet and --verbose of all commands.

class Ranks;

/// Adds both options to `program` and to all its commands, and lists them with --help and --help-all under one heading.
/// Call add_verbosity_options() after all commands are added. Only rank 0 is verbose. Each option may be given twice;
/// giving both options is a UserError.
void add_verbosity_options(CLI::App& program, const Ranks& ranks);

// Options whose values are files or folders, and a check that no output overwrites an input or another output.

/// How a command uses the file or folder that an option names. kNone: the option names neither.
enum class FileUse { kNone, kRead, kWritten, kKernelFolder, kWrittenFolder };

/// Sets how the command uses the option's file.
CLI::Option* set_file_use(CLI::Option* option, FileUse use);
FileUse file_use_of(const CLI::Option& option);

/// Adds an option for a file or folder, as add_value() does.
template <class Value>
CLI::Option* add_file(CLI::App& command, FileUse use, const std::string& name, Value& value, const std::string& help,
                      const std::string& brief = "") {
    return set_file_use(add_value(command, name, value, help, brief), use);
}

/// Adds --kernel-dir, whose value is stored in `folder`, and --il.
void add_kernel_source_options(CLI::App& command, std::string& folder);

/// A file and its option. The option's value is the file's name, or the file's name is derived from that value.
struct NamedFile {
    std::string option, file;
};

/// Throws UserError if an output is the same file as an input or another output, also through links. Throws UserError
/// if an output is not writable. Checks the files of the command's options and `more_outputs`. The parser calls
/// check_files() before the callback of every command. A command that derives further output names from an option calls
/// check_files() again with these names before it writes.
void check_files(const CLI::App& command, const std::vector<NamedFile>& more_outputs = {});

}  // namespace raya
