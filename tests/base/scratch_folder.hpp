// A new folder for a test case; the destructor removes the folder.
#pragma once
#include <filesystem>
#include <iterator>

#include "host/base/child_process.hpp"

namespace raya {

class ScratchFolder : public TemporaryFolder {
  public:
    ScratchFolder() : TemporaryFolder("raya-test") {}

    /// Returns the number of entries of the folder.
    long entries() const {
        return std::distance(std::filesystem::directory_iterator(path()), std::filesystem::directory_iterator());
    }
};

}  // namespace raya
