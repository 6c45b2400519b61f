// Remarks of the readers of scene files.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

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

}  // namespace raya
