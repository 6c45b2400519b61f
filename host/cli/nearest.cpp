#include "host/cli/nearest.hpp"

#include <algorithm>

namespace raya {
namespace {

/// Returns Damerau's edit distance from `a` to `b` without repeated edits of a character (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> distance(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) {
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                distance[i][j] = i + j;
                continue;
            }
            const std::size_t substitution = a[i - 1] == b[j - 1] ? 0 : 1;
            distance[i][j] =
                std::min({distance[i - 1][j] + 1, distance[i][j - 1] + 1, distance[i - 1][j - 1] + substitution});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                distance[i][j] = std::min(distance[i][j], distance[i - 2][j - 2] + 1);
        }
    }
    return distance[a.size()][b.size()];
}

}  // namespace

std::string nearest_name(const std::string& misspelling, const std::vector<std::string>& names) {
    constexpr std::size_t kMinPrefixSize = 3;
    std::string nearest;
    std::size_t min_distance = misspelling.size() / 3 + 1;
    for (const std::string& name : names) {
        const bool has_prefix = misspelling.size() >= kMinPrefixSize && name.starts_with(misspelling);
        const std::size_t distance = has_prefix ? 0 : edit_distance(misspelling, name);
        if (distance >= min_distance) continue;
        min_distance = distance;
        nearest = name;
    }
    return nearest;
}

std::string did_you_mean(const std::string& misspelling, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(misspelling, names);
    return nearest.empty() ? "" : " (did you mean " + nearest + "?)";
}

}  // namespace raya
