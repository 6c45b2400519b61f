#include "host/cli/file_options.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <map>

#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/cl/spirv.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/mesh/mesh_file.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFileUseNote = "file use";

class FileCheck {
  public:
    void add_input(const NamedFile& input) {
        std::error_code error;
        const fs::path file = is_standard_stream(input.file) ? "/dev/stdin" : input.file;
        if (fs::exists(file, error)) inputs_.emplace(file_identity(file), input);
    }

    void add_kernels(const NamedFile& folder) {
        constexpr std::string_view kKernels = "kernels/";
        check_kernel_folder({.folder = folder.file});
        for (const auto& [name, text] : embedded_files())
            if (name.starts_with(kKernels))
                add_input({folder.option, (fs::path(folder.file) / name.substr(kKernels.size())).string()});
    }

    void add_output(const NamedFile& output) {
        output_names_.push_back(output.file);
        const std::string identity = identity_of(output);
        if (identity.empty()) return;
        refuse_if_input(output, identity);
        const auto [entry, is_new] = outputs_.emplace(identity, output);
        if (!is_new) refuse_equal_outputs(output, entry->second);
    }

    // Refuses an output folder that contains an input of the command, because the command might overwrite the input.
    // Ignores scenes, because no command writes scenes to an output folder.
    void check_output_folder(const NamedFile& folder) const {
        std::error_code error;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder.file, error))
            if (entry.path().extension() != ".nff" && !is_mesh_file(entry.path()))
                refuse_if_input({folder.option, entry.path().string()}, file_identity(entry.path()));
    }

    /// Call check_all_writable() after all files are added, because check_all_writable() redirects stdout.
    void check_all_writable() const {
        for (const std::string& file : output_names_) check_writable(file);
    }

  private:
    static std::string identity_of(const NamedFile& output) {
        if (!is_standard_stream(output.file)) return file_identity(output.file);
        // If an earlier check has reserved stdout for a file, /dev/stdout refers to stderr.
        const std::string stdout_file = stdout_is_reserved() ? "" : file_identity("/dev/stdout");
        return stdout_file.empty() ? output.file : stdout_file;
    }

    void refuse_if_input(const NamedFile& output, const std::string& identity) const {
        const auto input = inputs_.find(identity);
        if (input == inputs_.end() || identity.empty()) return;
        throw UserError(fmt::format("{} {}: would overwrite the input {} {}; name another file", output.option,
                                    output.file, input->second.option, input->second.file));
    }

    [[noreturn]] static void refuse_equal_outputs(const NamedFile& output, const NamedFile& earlier_output) {
        if (is_standard_stream(output.file) && is_standard_stream(earlier_output.file))
            throw UserError(
                fmt::format("{} - and {} -: only one file can go to stdout; name files for the other options",
                            earlier_output.option, output.option));
        throw UserError(fmt::format("{} {}: the same file as {} {}; name another file", output.option, output.file,
                                    earlier_output.option, earlier_output.file));
    }

    std::map<std::string, NamedFile> inputs_, outputs_;  // key: file_identity()
    std::vector<std::string> output_names_;
};

}  // namespace

CLI::Option* set_file_use(CLI::Option* option, FileUse use) {
    return attach_note(option, kFileUseNote, std::to_string(static_cast<int>(use)));
}

void add_kernel_source_options(CLI::App& command, std::string& folder) {
    add_file(command, FileUse::kKernelFolder, "--kernel-dir", folder, "DIR",
             "Read the kernels from this folder, for kernel development");
    command.add_flag_callback("--il", use_il,
                              "Compile the kernels to SPIR-V with clang and llvm-spirv, and give the driver SPIR-V "
                              "instead of source; like --il in RAYA_BUILD_OPTIONS; the image does not change");
}

FileUse file_use_of(CLI::Option& option) {
    const std::string use = note_of(option, kFileUseNote);
    return use.empty() ? FileUse::kNone : static_cast<FileUse>(std::stoi(use));
}

void check_files(const CLI::App& command, const std::vector<NamedFile>& more_outputs) {
    FileCheck check;
    const auto for_each_file = [&](FileUse use, auto add) {
        for (CLI::Option* option : const_cast<CLI::App&>(command).get_options())
            if (option->count() > 0 && file_use_of(*option) == use)
                for (const std::string& file : option->results()) add(NamedFile{option->get_name(), file});
    };
    for_each_file(FileUse::kRead, [&](const NamedFile& file) { check.add_input(file); });
    for_each_file(FileUse::kKernelFolder, [&](const NamedFile& folder) { check.add_kernels(folder); });
    for_each_file(FileUse::kWrittenFolder, [&](const NamedFile& folder) { check.check_output_folder(folder); });
    for_each_file(FileUse::kWritten, [&](const NamedFile& file) { check.add_output(file); });
    for (const NamedFile& file : more_outputs) check.add_output(file);
    check.check_all_writable();
}

}  // namespace raya
