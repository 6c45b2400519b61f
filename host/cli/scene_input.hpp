// Reading of the scene that the command line names, and warnings.
#pragma once
#include <string>
#include <vector>

#include "host/model/number_format.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/remark.hpp"
#include "host/scene/scene.hpp"

namespace CLI {
class App;
}

namespace raya {

/// Prints each new warning on stderr and stores it for the report. Ignores repeated warnings.
class Warnings {
  public:
    void add(const std::string& text);
    const std::vector<std::string>& texts() const { return texts_; }

  private:
    std::vector<std::string> texts_;
};

/// Adds --strict, with which raya refuses contents that are not NFF or cannot be traced, instead of skipping or
/// changing these contents.
void add_strict_option(CLI::App& command, bool& strict);

/// Help of the argument SCENE.
inline constexpr const char* kSceneHelp =
    "Scene in NFF, the format of the SPD programs, or a mesh: .obj, .ply, .gltf, .glb, .stl; -: NFF from stdin";

/// Returns the extensions of scenes: ".nff" and those of meshes.
std::vector<std::string> scene_extensions();

struct SceneInput {
    Scene scene;
    std::vector<SceneRemark> remarks;  // contents of the file that were skipped or changed
    Warnings warnings;
};

/// Reads a scene from a file or stdin ("-"). Warns of skipped and changed contents. Throws UserError as
/// read_scene_file() does.
SceneInput read_scene(const std::string& file, bool strict);

/// Warns of options in the environment variable RAYA_BUILD_OPTIONS that may change pixels and counts.
void warn_of_build_options(Warnings& warnings);

/// Warns if every ray is tested against 100,000 objects or more, because no accelerator is used.
void warn_of_slow_search(const Scene& scene, bool accelerated, Warnings& warnings);

/// Warns if objects are too small to be visible in this format. The limit depends on the scene's largest length.
void warn_of_lost_objects(const Scene& scene, const LengthScale& scale, const NumberFormat& format, Warnings& warnings);

}  // namespace raya
