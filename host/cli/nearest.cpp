#include "host/cli/nearest.hpp"

#include <algorithm>

namespace raya {
namespace {

/// Returns Damerau's edit distance from `a` to `b` without repeated edits of a character (optimal string alignment).
std::size_t edits(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> of(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) {
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                of[i][j] = i + j;
                continue;
            }
            const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
            of[i][j] = std::min({of[i - 1][j] + 1, of[i][j - 1] + 1, of[i - 1][j - 1] + change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                of[i][j] = std::min(of[i][j], of[i - 2][j - 2] + 1);
        }
    }
    return of[a.size()][b.size()];
}

}  // namespace

std::string nearest_name(const std::string& word, const std::vector<std::string>& names) {
    constexpr std::size_t kMinPrefix = 3;
    std::string nearest;
    std::size_t smallest = word.size() / 3 + 1;
    for (const std::string& name : names) {
        const bool begins = word.size() >= kMinPrefix && name.starts_with(word);
        const std::size_t distance = begins ? 0 : edits(word, name);
        if (distance >= smallest) continue;
        smallest = distance;
        nearest = name;
    }
    return nearest;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(word, names);
    return nearest.empty() ? "" : " (did you mean " + nearest + "?)";
}

}  // namespace raya
