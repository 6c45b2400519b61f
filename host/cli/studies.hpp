// What the studies' commands share.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace raya {

/// Makes the folder, and refuses it before the work rather than after if the files could not be written. UserError.
void prepare_folder(const std::filesystem::path& folder, const std::vector<std::string>& files);

/// Adds the load laboratory's studies, and `all`, to `raya study`.
void add_laboratory_studies(CLI::App& study);

}  // namespace raya
