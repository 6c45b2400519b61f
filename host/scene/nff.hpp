// Scenes in NFF, the Neutral File Format, as the SPD programs write it (E. Haines, "A Proposal for Standard Graphics
// Environments", IEEE CG&A 7(11), 1987; SPD 3.9).
//
//     v from x y z at x y z up x y z angle degrees hither distance resolution width height        view
//     b r g b                               background; black by default
//     l x y z [r g b]                       light
//     f r g b Kd Ks Shine T ior             surface of the objects that follow; by default white with Kd = 1
//     s x y z radius                        sphere
//     p n, then n times x y z               polygon
//     pp n, then n times x y z nx ny nz     patch: polygon with a normal at each vertex
//     c x y z radius, x y z radius          cone or cylinder from base to apex, without caps
//     #raya plane nx ny nz d                infinite plane: points p with n.p = d
//     #raya checker r g b r g b size        checker for the next plane, polygon or patch
//     # anything else                       comment
//
// An entity starts on a new line. Its numbers may span several lines, except after `#raya`. All six parts of `v` are
// required, in any order. `hither` does not change the image.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// A remark on a part of a file that a reader has left out or changed. Equal remarks are stored once and counted. The
/// place of the first occurrence is a line of an NFF file, or a text for a mesh.
struct SceneRemark {
    std::string what;         // description: "polygon without area, left out"
    std::uint64_t count = 1;  // number of equal remarks
    int line = 0;             // line of the first occurrence; 0: see `place`
    std::string place{};      // "mesh 'wheel', face 12"; empty: the whole file
};

/// Adds a remark, or only its count if there is an equal one.
void add_remark(std::vector<SceneRemark>& remarks, const SceneRemark& remark);

/// Returns the remark as text: "FILE:LINE: polygon without area, left out (3 in all)" or "FILE: PLACE: ...".
std::string remark_text(const std::string& file, const SceneRemark& remark);

/// Parses NFF. In the returned scene, equal surfaces are merged (merge_equal_surfaces()), and normals have length 1.
/// The scene's name is `name` without folder. Throws UserError "NAME:LINE: reason" if the text is not NFF or the scene
/// cannot be traced.
///
/// If `remarks` is not null, parse_nff() tolerates the following deviations and adds a remark for each: it leaves out
/// objects without size and polygons without area, cuts polygons that are not flat into triangles, converts patches
/// with a normal of 0 into polygons, and skips entities of other NFF dialects (la, lf, tt, ...).
/// Other text, a missing view and a file without objects remain errors.
Scene parse_nff(std::string_view text, const std::string& name, std::vector<SceneRemark>* remarks = nullptr);

/// Reads and parses a file; "-" reads from stdin, which is named "stdin" in messages. Throws UserError as parse_nff()
/// does, and UserError "NAME: reason" if the file cannot be read.
Scene read_nff(const std::filesystem::path& path, std::vector<SceneRemark>* remarks = nullptr);

/// Returns the text in single quotes, shortened to 24 characters, with '?' for each character that is not printable
/// ASCII.
std::string in_quotes(std::string_view text);

/// Returns a scene as NFF text. Numbers have the minimum number of digits that round-trip, so parse_nff() of the text
/// returns an equal scene if equal surfaces of `scene` are merged (merge_equal_surfaces()). Throws UserError for a
/// checker on a sphere or cone, which NFF cannot express.
std::string write_nff(const Scene& scene);

}  // namespace raya
