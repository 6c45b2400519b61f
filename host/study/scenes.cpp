#include "host/study/scenes.hpp"

#include <fmt/core.h>

#include "host/embedded.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff_reader.hpp"

namespace raya {

LabelledScene embedded_scene(const std::string& name) {
    const std::string file = "scenes/" + name + ".nff";
    return {name, parse_nff(embedded_files().at(file), file)};
}

LabelledScene one_of(const Scenes& named) { return named.empty() ? embedded_scene("centre") : named.front(); }

Scenes embedded_study_scenes() {
    Scenes scenes;
    for (const char* name : {"centre", "spheres", "glass", "polygons", "cones"}) scenes.push_back(embedded_scene(name));
    return scenes;
}

Scenes paper_like_scenes() {
    Scenes scenes;
    for (const char* name : {"centre", "spheres", "mirrors", "glass", "planes"}) scenes.push_back(embedded_scene(name));
    for (const int spheres : {6, 12, 20, 30})
        scenes.push_back(
            {fmt::format("random-{}", spheres), generate_random(spheres, static_cast<std::uint64_t>(spheres))});
    scenes.push_back({"uniform-27", generate_uniform(27, {3, 3, 3})});
    return scenes;
}

}  // namespace raya
