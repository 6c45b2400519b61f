// Files embedded in raya's executable.
#pragma once
#include <map>
#include <string>

namespace raya {

/// Returns the content of each embedded file by its path relative to the project's root: the files of kernels/, the
/// default scenes of `bench` and `study`, the list of studies, and the styles and scripts of HTML pages. The build
/// generates the definition of this function.
const std::map<std::string, std::string>& embedded_files();

}  // namespace raya
