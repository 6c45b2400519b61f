// Scenes that a user names, and what is said of them although they are traced.
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

/// What a user should know although the command goes on: said on stderr at once, and kept for the report.
class Warnings {
  public:
    void add(const std::string& text);
    const std::vector<std::string>& texts() const { return texts_; }

  private:
    std::vector<std::string> texts_;
};

/// Adds --strict: what a scene's file has beside NFF, or that cannot be traced, is refused and not passed over.
void add_strict_option(CLI::App& command, bool& strict);

struct SceneInput {
    Scene scene;
    std::vector<NffRemark> remarks;  // what was passed over in its file
    Warnings warnings;
};

/// The scene of a file, or of stdin ("-"). Warns of what is passed over. UserError as read_nff().
SceneInput read_scene(const std::string& file, bool strict);

/// Warns of options in RAYA_BUILD_OPTIONS that may change results.
void warn_of_build_options(Warnings& warnings);

/// Warns where so many objects are tested with every ray that it is hardly meant.
void warn_of_slow_search(const Scene& scene, bool accelerated, Warnings& warnings);

/// Warns of objects that a format cannot hold beside the scene's largest length.
void warn_of_lost_objects(const Scene& scene, const LengthScale& scale, const NumberFormat& format, Warnings& warnings);

}  // namespace raya
