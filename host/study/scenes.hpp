// The scenes that studies take by default, and names for them.
#pragma once
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// A scene under the name by which reports call it.
struct LabelledScene {
    std::string label;
    Scene scene;
};
using Scenes = std::vector<LabelledScene>;

/// A scene that the program carries within itself, by its name in scenes/, without .nff.
LabelledScene embedded_scene(const std::string& name);

/// For studies of one scene: the first of those that were named, else centre, the paper's kind.
LabelledScene one_of(const Scenes& named);

/// centre, spheres, glass, polygons, cones.
Scenes embedded_study_scenes();

/// Ten scenes of 6 to 30 spheres and planes, as in the paper's experiments: the project's own of that size, and
/// generated ones.
Scenes paper_like_scenes();

}  // namespace raya
