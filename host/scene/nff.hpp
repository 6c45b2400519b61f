// Scenes in NFF, the Neutral File Format, as the SPD programs write it (E. Haines, "A Proposal for Standard Graphics
// Environments", IEEE CG&A 7(11), 1987; SPD 3.9).
//
//     v / from x y z / at x y z / up x y z / angle degrees / hither distance / resolution width height
//     b r g b                               background; black without it
//     l x y z [r g b]                       light
//     f r g b Kd Ks Shine T ior             surface of the objects that follow; white with Kd = 1 before the first
//     s x y z radius                        sphere
//     p n, then n times x y z               polygon
//     pp n, then n times x y z nx ny nz     patch: polygon with a normal at each vertex
//     c x y z radius, x y z radius          cone or cylinder from base to apex, without caps
//     #raya plane nx ny nz d                infinite plane n.x = d
//     #raya checker r g b r g b size        checker for the next plane, polygon or patch
//     # anything else                       comment
//
// An entity starts on a new line; its numbers may be spread over lines as one likes, but what follows `#raya` stands on
// one line. All six parts of `v` must be given, in any order. Where `hither` lies does not matter, so any number will
// do.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// What a file has and its scene has not, or not as it stands there: all of one kind.
struct NffRemark {
    std::string what;  // "polygon without area, left out"
    std::uint64_t count = 0;
    int line = 0;  // of the first
};

/// Counts one more of its kind.
void add_remark(std::vector<NffRemark>& remarks, const std::string& what, int line);

/// "FILE:LINE: polygon without area, left out (3 in all)".
std::string remark_text(const std::string& file, const NffRemark& remark);

/// The scene that `text` describes, with shared surfaces (share_surfaces) and normals of length 1. Scene::name is
/// `name` without folder. Throws UserError "NAME:LINE: reason" for anything that is not NFF or cannot be traced.
///
/// Where `remarks` has a place, what other programs put up with is passed over and remarked, never taken silently:
/// objects without size and facets without area are left out; polygons that are not flat are cut into triangles;
/// patches with a normal of 0 become polygons; entities of other dialects (la, lf, tt, ...) and a mail header are
/// skipped. Nothing that reads as prose is, and a file without view or objects is no scene.
Scene parse_nff(std::string_view text, const std::string& name, std::vector<NffRemark>* remarks = nullptr);

/// Reads a file, or stdin ("-"), whose name is "stdin" then. Throws UserError as parse_nff() does, and "NAME: reason"
/// where the file cannot be read.
Scene read_nff(const std::filesystem::path& path, std::vector<NffRemark>* remarks = nullptr);

/// The scene as NFF text. Numbers have the fewest digits that read back as the same double, so parse_nff() of the text
/// gives an equal scene where `scene` has shared surfaces (share_surfaces). Throws UserError for a checker on a sphere
/// or cone, which NFF cannot express.
std::string write_nff(const Scene& scene);

}  // namespace raya
