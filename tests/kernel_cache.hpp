// The PoCL kernel cache of a test program. Each program has its own cache, because a program may read an entry that
// another program is replacing (pocl issue 586). The cache starts with the kernels that earlier programs built, so that
// a kernel that several programs need is built only once.
#pragma once
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "host/base/child_process.hpp"

namespace raya {

/// Sets POCL_CACHE_DIR to a new folder. The environment variable RAYA_KERNEL_STORE may name a folder that the test
/// programs of this and later runs share (tools/test). PoCL derives an entry's name from source, options, device and
/// driver, and a failed build adds no entry (test_program.cpp). Without RAYA_KERNEL_STORE the cache starts empty.
class KernelCache {
  public:
    KernelCache() {
        setenv("POCL_CACHE_DIR", folder_.path().c_str(), 1);
        if (!store_.empty() && std::filesystem::is_directory(store_)) add_missing(store_, folder_.path());
    }

    /// Adds the kernels that this program built to the store.
    ~KernelCache() {
        if (!store_.empty()) add_missing(folder_.path(), store_);
    }

    KernelCache(const KernelCache&) = delete;
    KernelCache& operator=(const KernelCache&) = delete;

  private:
    static std::filesystem::path store() {
        const char* const named = std::getenv("RAYA_KERNEL_STORE");
        return named == nullptr ? "" : named;
    }

    // Adds the files that are missing in `to`. Several programs may do so at once: each file appears complete or not at
    // all, and existing files stay unchanged.
    static void add_missing(const std::filesystem::path& from, const std::filesystem::path& to) {
        std::error_code error;  // after an error (file removed, disk full), the kernel is built again
        for (const auto& entry : std::filesystem::recursive_directory_iterator(from, error)) {
            const std::filesystem::path target = to / entry.path().lexically_relative(from);
            if (!entry.is_regular_file(error) || is_unfinished(entry.path()) || std::filesystem::exists(target, error))
                continue;
            const std::filesystem::path part = target.string() + ".part" + std::to_string(getpid());
            std::filesystem::create_directories(target.parent_path(), error);
            std::filesystem::create_hard_link(entry.path(), target, error);  // PoCL never rewrites a file
            if (!error) continue;
            if (std::filesystem::copy_file(entry.path(), part, error)) std::filesystem::rename(part, target, error);
        }
    }

    static bool is_unfinished(const std::filesystem::path& file) {
        const std::string name = file.filename().string();
        return name.find(".part") != std::string::npos || name.starts_with("tempfile");
    }

    std::filesystem::path store_ = store();
    // The cache is on the store's file system, because hard links do not work across file systems.
    TemporaryFolder folder_{store_.empty() ? "raya-test-kernels" : (store_.parent_path() / "kernels").string()};
};

}  // namespace raya
