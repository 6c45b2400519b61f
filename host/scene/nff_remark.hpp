// What a reader of NFF passed over.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

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

}  // namespace raya
