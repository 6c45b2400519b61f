#include "ring/mapping.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "error.hpp"

namespace raya {

const std::vector<std::string>& mapping_names() {
    static const std::vector<std::string> names = {"cyclic", "column"};
    return names;
}

raya_mapping make_mapping(const std::string& name, std::uint32_t width, std::uint32_t height, std::uint32_t pes,
                          std::uint32_t offset, const std::string& fold) {
    const auto& names = mapping_names();
    if (std::find(names.begin(), names.end(), name) == names.end())
        throw UserError(fmt::format("--mapping {}: no such mapping, there are {}", name, fmt::join(names, ", ")));
    if (fold != "cyclic" && fold != "block") throw UserError(fmt::format("--fold {}: must be cyclic or block", fold));
    if (width < 1 || width > kLargestSide || height < 1 || height > kLargestSide)
        throw UserError(fmt::format("--size {}x{}: both sides must be 1..{} pixels", width, height, kLargestSide));
    if (pes < 1 || pes > width * height)
        throw UserError(fmt::format("--pes {}: must be 1..{}, a PE for each pixel at most", pes, width * height));
    if (name == "column") offset = 0;
    if (offset >= width)
        throw UserError(fmt::format("--offset {}: must be 0..{}, less than the image's width", offset, width - 1));
    return {width, height, pes, offset, fold == "block" ? RAYA_FOLD_BLOCK : RAYA_FOLD_CYCLIC};
}

std::uint32_t largest_share(const raya_mapping& mapping) {
    std::uint32_t largest = 0;
    for (std::uint32_t pe = 0; pe < mapping.pes; ++pe)
        largest = std::max(largest, raya_share_size(raya_share_of(mapping, pe)));
    return largest;
}

}  // namespace raya
