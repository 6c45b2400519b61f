#include "host/scene/remark.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace raya {

void add_remark(std::vector<SceneRemark>& remarks, const SceneRemark& remark) {
    const auto equal_remark = std::find_if(remarks.begin(), remarks.end(),
                                           [&](const SceneRemark& known) { return known.what == remark.what; });
    if (equal_remark == remarks.end())
        remarks.push_back(remark);
    else
        equal_remark->count += remark.count;
}

std::string remark_text(const std::string& file, const SceneRemark& remark) {
    std::string place = file;
    if (remark.line > 0) place += fmt::format(":{}", remark.line);
    if (!remark.place.empty()) place += ": " + remark.place;
    const std::string total = remark.count > 1 ? fmt::format(" ({} in all)", remark.count) : "";
    return fmt::format("{}: {}{}", place, remark.what, total);
}

}  // namespace raya
