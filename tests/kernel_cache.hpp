// The kernel cache of a test program: its own, since two programs must not write one (pocl issue 586: what one has half
// replaced the other reads), filled with what programs before it have built. So a kernel that several need is built
// once.
#pragma once
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/base/scratch_folder.hpp"

namespace raya {

/// Sets POCL_CACHE_DIR to a fresh folder. The environment variable RAYA_KERNEL_STORE may name a folder that all
/// programs of one run share (tools/test makes it, anew each time: a kernel that no longer builds must not pass because
/// an older one does); without it the cache starts empty.
class KernelCache {
  public:
    KernelCache() {
        setenv("POCL_CACHE_DIR", folder_.path().c_str(), 1);
        if (const char* store = std::getenv("RAYA_KERNEL_STORE"); store != nullptr && *store != '\0') store_ = store;
        if (!store_.empty() && std::filesystem::is_directory(store_)) add_missing(store_, folder_.path());
    }

    /// Adds what has been built to the store.
    ~KernelCache() {
        if (!store_.empty()) add_missing(folder_.path(), store_);
    }

    KernelCache(const KernelCache&) = delete;
    KernelCache& operator=(const KernelCache&) = delete;

  private:
    // Others may do the same at the same time: a file appears whole or not at all, and one that is there stays.
    static void add_missing(const std::filesystem::path& from, const std::filesystem::path& to) {
        std::error_code none;  // a file that is gone, or a full disk: then a kernel is built twice
        for (const auto& entry : std::filesystem::recursive_directory_iterator(from, none)) {
            const std::filesystem::path target = to / entry.path().lexically_relative(from);
            if (!entry.is_regular_file(none) || is_unfinished(entry.path()) || std::filesystem::exists(target, none))
                continue;
            const std::filesystem::path part = target.string() + ".part" + std::to_string(getpid());
            std::filesystem::create_directories(target.parent_path(), none);
            if (std::filesystem::copy_file(entry.path(), part, none)) std::filesystem::rename(part, target, none);
        }
    }

    static bool is_unfinished(const std::filesystem::path& file) {
        const std::string name = file.filename().string();
        return name.find(".part") != std::string::npos || name.starts_with("tempfile");
    }

    ScratchFolder folder_;
    std::filesystem::path store_;
};

}  // namespace raya
