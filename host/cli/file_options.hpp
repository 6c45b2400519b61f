// Options that name files and folders; the check that no output overwrites an input or another output.
#pragma once
#include <string>
#include <vector>

#include "host/cli/options.hpp"

namespace raya {

/// How a command uses the file or folder that an option names.
enum class FileUse { kNone, kRead, kWritten, kKernelFolder, kWrittenFolder };

/// Sets the use of an option's value.
CLI::Option* set_file_use(CLI::Option* option, FileUse use);
FileUse file_use_of(CLI::Option& option);

/// add_value() for a file or folder; `type`: the placeholder in help.
template <class Value>
CLI::Option* add_file(CLI::App& command, FileUse use, const std::string& name, Value& value, const std::string& type,
                      const std::string& help) {
    return set_file_use(add_value(command, name, value, help)->type_name(type), use);
}

/// A file that an option names, directly or derived from its value.
struct NamedFile {
    std::string option, file;
};

/// Checks the files of the command's options and `more_outputs`: no output is the same file as an input or another
/// output, under any name, and each output is writable. Runs before the callback of every command; a command with
/// derived output files calls it again with those before it writes. UserError.
void check_files(const CLI::App& command, const std::vector<NamedFile>& more_outputs = {});

}  // namespace raya
