// What the studies' commands share.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace raya {

/// The folder of a study's files.
class StudyFolder {
  public:
    /// Makes it, and refuses it before the work rather than after if the files could not be written. UserError.
    StudyFolder(const std::filesystem::path& folder, const std::vector<std::string>& files);
    /// Folders that it has made are gone again if nothing lies in them.
    ~StudyFolder();
    StudyFolder(const StudyFolder&) = delete;
    StudyFolder& operator=(const StudyFolder&) = delete;

  private:
    std::vector<std::filesystem::path> made_;  // the innermost first
};

/// Adds the examples that all studies have.
void add_study_examples(CLI::App& command);

/// Adds the load laboratory's studies, and `all`, to `raya study`.
void add_laboratory_studies(CLI::App& study);

}  // namespace raya
