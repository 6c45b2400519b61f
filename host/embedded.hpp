// Files embedded in the program.
#pragma once
#include <map>
#include <string>

namespace raya {

/// Texts by path relative to the project's root: kernels/, the default scenes of `bench` and `study`, the list of
/// studies, styles and scripts of pages. The build generates the definition.
const std::map<std::string, std::string>& embedded_files();

}  // namespace raya
