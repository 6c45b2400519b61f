// Files that the program carries within itself, so that it runs from anywhere.
#pragma once
#include <map>
#include <string>

namespace raya {

/// Text by path from the project's root: everything below kernels/, the scenes that `bench` and `study` take by
/// default, the names of studies, styles and scripts of pages. Defined in a file that the build makes.
const std::map<std::string, std::string>& embedded_files();

}  // namespace raya
