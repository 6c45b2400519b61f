// A new folder for a test case, removed at its end.
#pragma once
#include <filesystem>
#include <iterator>

#include "tests/base/temporary_folder.hpp"

namespace raya {

class ScratchFolder : public TemporaryFolder {
  public:
    ScratchFolder() : TemporaryFolder("raya-test") {}

    /// The number of entries of the folder.
    long entries() const {
        return std::distance(std::filesystem::directory_iterator(path()), std::filesystem::directory_iterator());
    }
};

}  // namespace raya
