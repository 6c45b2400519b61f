// Options that name files and folders, and the check that no output of a command overwrites another file of it.
#pragma once
#include <string>
#include <vector>

#include "host/cli/options.hpp"

namespace raya {

/// What a command does with the file or folder that an option names.
enum class FileUse { kNone, kRead, kWritten, kKernelFolder, kWrittenFolder };

/// Declares the use of an option's value.
CLI::Option* set_file_use(CLI::Option* option, FileUse use);
FileUse file_use(CLI::Option& option);

/// add_value() of a file or folder; `type`: how help calls the value.
template <class Value>
CLI::Option* add_file(CLI::App& command, FileUse use, const std::string& name, Value& value, const std::string& type,
                      const std::string& help) {
    return set_file_use(add_value(command, name, value, help)->type_name(type), use);
}

/// A file that an option names, or that follows from its value.
struct NamedFile {
    std::string option, file;
};

/// Refuses, of the files that the command's options name and of `more_outputs`, an output that is also an input or
/// another output, by whatever names, and an output that cannot be written. Runs for every command before its callback;
/// a command whose options lead to other outputs calls it again with those before it writes anything. UserError.
void check_files(const CLI::App& command, const std::vector<NamedFile>& more_outputs = {});

}  // namespace raya
