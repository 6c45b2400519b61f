#include "host/report_page/maps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/image/preview.hpp"

namespace raya {
namespace {

// OKLCH (B. Ottosson, "A perceptual color space for image processing", 2020) as linear light, so that all hues are as
// light. Hue: degrees.
void append_colour(Image& image, double light, double chroma, double hue) {
    const double turn = hue * 3.14159265358979 / 180, a = chroma * std::cos(turn), b = chroma * std::sin(turn);
    const auto cube = [](double v) { return v * v * v; };
    const double l = cube(light + 0.3963377774 * a + 0.2158037573 * b),
                 m = cube(light - 0.1055613458 * a - 0.0638541728 * b),
                 s = cube(light - 0.0894841775 * a - 1.291485548 * b);
    for (const double v : {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                           -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                           -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s})
        image.rgb.push_back(static_cast<float>(std::clamp(v, 0.0, 1.0)));
}

// Values as colours about their mean.
class Diverging {
  public:
    explicit Diverging(const std::vector<double>& values)
        : mean_(std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size())) {
        for (const double value : values) farthest_ = std::max(farthest_, std::abs(value - mean_));
    }
    void append(Image& image, double value) const {
        const double way = farthest_ > 0 ? std::clamp((value - mean_) / farthest_, -1.0, 1.0) : 0, far = std::abs(way);
        append_colour(image, 0.93 - 0.4 * far, 0.17 * far, way < 0 ? 255 : 29);
    }

  private:
    double mean_, farthest_ = 0;
};

}  // namespace

Image load_map(const raya_mapping& m, const std::vector<double>& loads) {
    const Diverging colours(loads);
    const auto longest = static_cast<int>(std::max(m.width, m.height));
    Image map{preview_side(static_cast<int>(m.width), longest), preview_side(static_cast<int>(m.height), longest), {}};
    const auto width = static_cast<std::uint32_t>(map.width), height = static_cast<std::uint32_t>(map.height);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            double sum = 0, pixels = 0;
            for (std::uint32_t row = y * m.height / height; row < (y + 1) * m.height / height; ++row)
                for (std::uint32_t column = x * m.width / width; column < (x + 1) * m.width / width; ++column) {
                    sum += loads.at(raya_owner(m, row, column));
                    ++pixels;
                }
            colours.append(map, sum / pixels);
        }
    return map;
}

Image owner_close_up(const raya_mapping& m) {
    const std::uint32_t width = std::min(m.width, kCloseUpSide), height = std::min(m.height, kCloseUpSide);
    Image map{static_cast<int>(width), static_cast<int>(height), {}};
    for (std::uint32_t row = 0; row < height; ++row)
        for (std::uint32_t column = 0; column < width; ++column)
            append_colour(map, 0.72, 0.14, 205 + 360.0 * raya_owner(m, row, column) / m.pes);
    return map;
}

Image node_map(const raya_torus& t, const std::vector<double>& values) {
    const Diverging colours(values);
    std::uint32_t beside = 1;  // slices in a row
    while (beside * beside < t.nodes[2]) ++beside;
    const std::uint32_t below = (t.nodes[2] + beside - 1) / beside, wide = t.nodes[0] + 1, high = t.nodes[1] + 1;
    const std::uint32_t width = beside * wide - 1, height = below * high - 1;
    Image map{static_cast<int>(width), static_cast<int>(height), {}};
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t k = y / high * beside + x / wide, i = x % wide, j = y % high;
            if (i < t.nodes[0] && j < t.nodes[1] && k < t.nodes[2])
                colours.append(map, values.at(raya_node_of(t, i, j, k)));
            else
                append_colour(map, 0.45, 0, 0);  // between slices
        }
    return map;
}

}  // namespace raya
