// Options whose values are files or folders, and a check that no output overwrites an input or another output.
#pragma once
#include <string>
#include <vector>

#include "host/cli/options.hpp"

namespace raya {

/// How a command uses the file or folder that an option names. kNone: the option names neither.
enum class FileUse { kNone, kRead, kWritten, kKernelFolder, kWrittenFolder };

/// Sets how the command uses the option's file.
CLI::Option* set_file_use(CLI::Option* option, FileUse use);
FileUse file_use_of(CLI::Option& option);

/// Adds an option for a file or folder, as add_value() does. `type`: the placeholder of the value in help.
template <class Value>
CLI::Option* add_file(CLI::App& command, FileUse use, const std::string& name, Value& value, const std::string& type,
                      const std::string& help) {
    return set_file_use(add_value(command, name, value, help)->type_name(type), use);
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
