// Writes a scene as NFF, in the form that nff_reader.hpp describes.
#pragma once
#include <string>

#include "host/scene/scene.hpp"

namespace raya {

/// The scene as NFF text. Numbers have the fewest digits that read back as the same double, so parse_nff() of the text
/// gives an equal scene where `scene` has shared surfaces (share_surfaces). Throws UserError for a checker on a sphere
/// or cone, which NFF cannot express.
std::string write_nff(const Scene& scene);

}  // namespace raya
