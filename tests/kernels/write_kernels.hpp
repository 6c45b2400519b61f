// Writes a patched copy of the kernels for programs that read it with --kernel-dir.
#pragma once
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/cl/kernel_source.hpp"
#include "host/embedded.hpp"

namespace raya {

/// Writes all kernel files, with the patches applied, to the folder `to`, which it creates or overwrites. Returns the
/// folder's name. Throws like check_patches(), and std::runtime_error if a file cannot be written.
inline std::string write_kernels(const std::filesystem::path& to, const std::vector<SourcePatch>& patches = {}) {
    const KernelSources sources{.patches = patches};
    check_patches(sources);
    const std::string kernels = "kernels/";
    for (const auto& [path, text] : embedded_files()) {
        if (!path.starts_with(kernels)) continue;
        const std::string file = path.substr(kernels.size());
        std::filesystem::create_directories((to / file).parent_path());
        if (!(std::ofstream(to / file, std::ios::binary) << kernel_file(file, sources)).flush())
            throw std::runtime_error("cannot write " + (to / file).string());
    }
    return to.string();
}

}  // namespace raya
