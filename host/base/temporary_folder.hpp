// A new folder for temporary files. The destructor removes the folder and its contents.
#pragma once
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace raya {

class TemporaryFolder {
  public:
    /// Creates the folder. Its name starts with `name`. It is in the system's folder for temporary files, or, if `name`
    /// is an absolute path, in the parent folder of this path. Throws std::system_error if it cannot be created.
    explicit TemporaryFolder(const std::string& name) {
        const std::string random_part(6, 'X');  // mkdtemp() replaces these letters
        std::string made = (std::filesystem::temp_directory_path() / (name + "-" + random_part)).string();
        if (::mkdtemp(made.data()) == nullptr)
            throw std::system_error(errno, std::generic_category(), "cannot create a temporary folder: " + made);
        path_ = made;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

}  // namespace raya
