// How a scene is seen, as reports tell it.
#pragma once
#include "host/base/json.hpp"
#include "host/scene/scene.hpp"

namespace raya {

Json vector_json(const Vec3& v);

/// Camera, background and lights, each with the colour that it emits: what --from, --at, --up, --angle, --background
/// and
/// --light take to make the picture again.
Json view_json(const Scene& scene);

}  // namespace raya
