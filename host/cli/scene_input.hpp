// Reading scenes from the command line, with warnings.
#pragma once
#include <string>
#include <vector>

#include "host/model/number_format.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace CLI {
class App;
}

namespace raya {

/// Warnings: printed on stderr at once, and stored for the report.
class Warnings {
  public:
    void add(const std::string& text);
    const std::vector<std::string>& texts() const { return texts_; }

  private:
    std::vector<std::string> texts_;
};

/// Adds --strict: refuses, instead of skipping or changing, contents that are not NFF or cannot be traced.
void add_strict_option(CLI::App& command, bool& strict);

struct SceneInput {
    Scene scene;
    std::vector<NffRemark> remarks;  // contents of the file that were skipped or changed
    Warnings warnings;
};

/// Reads a scene from a file or stdin ("-"). Warns of skipped and changed contents. UserError as read_nff().
SceneInput read_scene(const std::string& file, bool strict);

/// Warns of options in RAYA_BUILD_OPTIONS that may change results.
void warn_of_build_options(Warnings& warnings);

/// Warns if every ray is tested against 100,000 objects or more.
void warn_of_slow_search(const Scene& scene, bool accelerated, Warnings& warnings);

/// Warns of objects that are too small for the format, given the scene's largest length.
void warn_of_lost_objects(const Scene& scene, const LengthScale& scale, const NumberFormat& format, Warnings& warnings);

}  // namespace raya
