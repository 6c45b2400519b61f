#include "host/cli/file_options.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <map>

#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUse = "file use";

class FileCheck {
  public:
    void read(const NamedFile& input) {
        std::error_code error;
        const fs::path file = is_standard_stream(input.file) ? "/dev/stdin" : input.file;
        if (fs::exists(file, error)) inputs_.emplace(file_identity(file), input);
    }

    void read_kernels(const NamedFile& folder) {
        constexpr std::string_view kKernels = "kernels/";
        check_folder({.folder = folder.file});
        for (const auto& [name, text] : embedded_files())
            if (name.starts_with(kKernels))
                read({folder.option, (fs::path(folder.file) / name.substr(kKernels.size())).string()});
    }

    void write(const NamedFile& output) {
        written_.push_back(output.file);
        const std::string identity = identity_of(output);
        if (identity.empty()) return;
        refuse_input(output, identity);
        const auto [other, is_new] = outputs_.emplace(identity, output);
        if (!is_new) refuse_output(output, other->second);
    }

    // Refuses an output folder that contains an input other than a scene, which the command might overwrite.
    void write_folder(const NamedFile& folder) const {
        std::error_code error;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder.file, error))
            if (entry.path().extension() != ".nff")
                refuse_input({folder.option, entry.path().string()}, file_identity(entry.path()));
    }

    /// Call it after all comparisons, because it redirects stdout.
    void check_all_writable() const {
        for (const std::string& file : written_) check_writable(file);
    }

  private:
    static std::string identity_of(const NamedFile& output) {
        if (!is_standard_stream(output.file)) return file_identity(output.file);
        // If an earlier check has reserved stdout for a file, /dev/stdout is stderr.
        const std::string stdout_file = stdout_is_reserved() ? "" : file_identity("/dev/stdout");
        return stdout_file.empty() ? output.file : stdout_file;
    }

    void refuse_input(const NamedFile& output, const std::string& identity) const {
        const auto input = inputs_.find(identity);
        if (input == inputs_.end() || identity.empty()) return;
        throw UserError(fmt::format("{} {}: would overwrite the input {} {}; name another file", output.option,
                                    output.file, input->second.option, input->second.file));
    }

    [[noreturn]] static void refuse_output(const NamedFile& output, const NamedFile& other) {
        if (is_standard_stream(output.file) && is_standard_stream(other.file))
            throw UserError(fmt::format("{} - and {} -: only one file can go to stdout; name files for the others",
                                        other.option, output.option));
        throw UserError(fmt::format("{} {}: the same file as {} {}; name another file", output.option, output.file,
                                    other.option, other.file));
    }

    std::map<std::string, NamedFile> inputs_, outputs_;  // key: file_identity()
    std::vector<std::string> written_;
};

}  // namespace

CLI::Option* set_file_use(CLI::Option* option, FileUse use) {
    return attach_note(option, kUse, std::to_string(static_cast<int>(use)));
}

FileUse file_use_of(CLI::Option& option) {
    const std::string use = note_of(option, kUse);
    return use.empty() ? FileUse::kNone : static_cast<FileUse>(std::stoi(use));
}

void check_files(const CLI::App& command, const std::vector<NamedFile>& more_outputs) {
    FileCheck check;
    const auto each = [&](FileUse use, auto take) {
        for (CLI::Option* option : const_cast<CLI::App&>(command).get_options())
            if (option->count() > 0 && file_use_of(*option) == use)
                for (const std::string& file : option->results()) take(NamedFile{option->get_name(), file});
    };
    each(FileUse::kRead, [&](const NamedFile& file) { check.read(file); });
    each(FileUse::kKernelFolder, [&](const NamedFile& folder) { check.read_kernels(folder); });
    each(FileUse::kWrittenFolder, [&](const NamedFile& folder) { check.write_folder(folder); });
    each(FileUse::kWritten, [&](const NamedFile& file) { check.write(file); });
    for (const NamedFile& file : more_outputs) check.write(file);
    check.check_all_writable();
}

}  // namespace raya
