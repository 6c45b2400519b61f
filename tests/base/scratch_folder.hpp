// A fresh folder for one test case, gone when it ends.
#pragma once
#include <filesystem>
#include <iterator>

#include "tests/base/temporary_folder.hpp"

namespace raya {

class ScratchFolder : public TemporaryFolder {
  public:
    ScratchFolder() : TemporaryFolder("raya-test") {}

    /// How many entries the folder has.
    long entries() const {
        return std::distance(std::filesystem::directory_iterator(path()), std::filesystem::directory_iterator());
    }
};

}  // namespace raya
