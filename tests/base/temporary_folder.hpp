// A fresh folder among the system's temporary files, gone with all in it when it goes out of scope.
#pragma once
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace raya {

class TemporaryFolder {
  public:
    /// Its name starts with `name`. std::system_error where none can be made.
    explicit TemporaryFolder(const std::string& name) {
        const std::string open_end(6, 'X');  // which mkdtemp fills in
        std::string made = (std::filesystem::temp_directory_path() / (name + "-" + open_end)).string();
        if (::mkdtemp(made.data()) == nullptr)
            throw std::system_error(errno, std::generic_category(), "no folder for temporary files, " + made);
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
