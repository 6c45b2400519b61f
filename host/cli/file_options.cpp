#include "host/cli/file_options.hpp"

#include <filesystem>

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
    forget_promised_outputs();  // of an earlier command in this process, or this command's own
    const auto for_each_file = [&](FileUse use, auto add) {
        for (CLI::Option* option : const_cast<CLI::App&>(command).get_options())
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
