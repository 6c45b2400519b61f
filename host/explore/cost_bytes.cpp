#include "host/explore/cost_bytes.hpp"

#include <algorithm>

#include "host/base/encoding.hpp"

namespace raya {

std::uint32_t bytes_of_cost(const CostImage& cost) {
    std::uint64_t most = cost.cycles.empty() ? 0 : *std::ranges::max_element(cost.cycles);
    std::uint32_t bytes = 1;
    while (most >>= 8) ++bytes;
    return bytes;
}

std::string cost_bytes(const CostImage& cost) {
    GzipText gzip;
    std::string plane(cost.cycles.size(), '\0');
    for (std::uint32_t byte = 0; byte < bytes_of_cost(cost); ++byte) {
        std::ranges::transform(cost.cycles, plane.begin(),
                               [byte](std::uint64_t cycles) { return static_cast<char>(cycles >> 8 * byte & 0xff); });
        gzip.append(plane);
    }
    return gzip.finish();
}

}  // namespace raya
