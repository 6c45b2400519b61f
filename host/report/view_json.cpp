#include "host/report/view_json.hpp"

#include <array>

namespace raya {

Json vector_json(const Vec3& v) { return std::array{v.x, v.y, v.z}; }

Json view_json(const Scene& scene) {
    Json lights = Json::list();
    for (const Light& light : scene.lights)
        lights.push_back(
            {{"position", vector_json(light.position)}, {"colour", vector_json(light_colour(scene, light))}});
    return {{"from", vector_json(scene.view.from)},
            {"at", vector_json(scene.view.at)},
            {"up", vector_json(scene.view.up)},
            {"angle_degrees", scene.view.angle_degrees},
            {"background", vector_json(scene.background)},
            {"lights", lights}};
}

}  // namespace raya
