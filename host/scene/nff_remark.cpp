#include "host/scene/nff_remark.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace raya {

void add_remark(std::vector<NffRemark>& remarks, const std::string& what, int line) {
    const auto same =
        std::find_if(remarks.begin(), remarks.end(), [&](const NffRemark& known) { return known.what == what; });
    if (same == remarks.end())
        remarks.push_back({what, 1, line});
    else
        ++same->count;
}

std::string remark_text(const std::string& file, const NffRemark& remark) {
    const std::string all = remark.count > 1 ? fmt::format(" ({} in all)", remark.count) : "";
    return fmt::format("{}:{}: {}{}", file, remark.line, remark.what, all);
}

}  // namespace raya
