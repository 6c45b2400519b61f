// Reference antialiasing for tests: functions of whole images, without PEs, mappings, blocks or rotations.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/image/image_io.hpp"
#include "host/model/number_format.hpp"

namespace raya::whole_image {

/// Arithmetic of a number format: each operation is computed in double and then rounded to the format. Rounding twice
/// does not change the result of an addition, subtraction or division of p-bit numbers if the wider format has at least
/// 2 p + 2 bits (S. Figueroa, "When is double rounding innocuous?", 1995); here 53 >= 2 * 24 + 2. The theorem does not
/// hold for formats that truncate, so tests must not use them.
class Arithmetic {
  public:
    explicit Arithmetic(const NumberFormat& format) : format_(format) {}

    float round(double value) const {
        return format_.is_fp32() ? static_cast<float>(value) : round_to_format(value, format_);
    }
    float add(double a, double b) const { return round(a + b); }
    float subtract(double a, double b) const { return round(a - b); }
    float divide(double a, double b) const { return round(a / b); }

  private:
    NumberFormat format_;
};

inline float value_at(const Image& image, int row, int column, int colour) {
    return image.rgb[3 * (std::size_t(row) * std::size_t(image.width) + std::size_t(column)) + std::size_t(colour)];
}

inline bool inside(const Image& image, int row, int column) {
    return row >= 0 && row < image.height && column >= 0 && column < image.width;
}

/// Returns an image whose values are `value(row, column, colour)`.
template <class Value>
Image make_image(int width, int height, Value&& value) {
    Image image{width, height, {}};
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            for (int colour = 0; colour < 3; ++colour) image.rgb.push_back(value(row, column, colour));
    return image;
}

/// Returns the image in which the pixel at offset (-down, -right) and then the pixel at offset (down, right) are added
/// to each pixel. Pixels outside the image are omitted.
inline Image line_sums(const Image& image, int down, int right, const Arithmetic& arithmetic) {
    return make_image(image.width, image.height, [&](int row, int column, int colour) {
        float sum = value_at(image, row, column, colour);
        for (const int sign : {-1, 1})
            if (inside(image, row + sign * down, column + sign * right))
                sum = arithmetic.add(sum, value_at(image, row + sign * down, column + sign * right, colour));
        return sum;
    });
}

/// Returns the image whose pixels are the means of the 3 x 3 neighbourhoods, clipped to the image. Sums are taken along
/// rows, then along columns.
inline Image filtered(const Image& image, const NumberFormat& format) {
    const Arithmetic arithmetic(format);
    const Image sums = line_sums(line_sums(image, 0, 1, arithmetic), 1, 0, arithmetic);
    return make_image(image.width, image.height, [&](int row, int column, int colour) {
        int pixels = 0;
        for (int down = -1; down <= 1; ++down)
            for (int right = -1; right <= 1; ++right) pixels += inside(image, row + down, column + right);
        return arithmetic.divide(value_at(sums, row, column, colour), pixels);
    });
}

/// Returns true if a colour component, clamped to 0..1, differs between the two pixels by at least `threshold`, which
/// must be a number of the format.
inline bool differ(const Image& image, int row, int column, int other_row, int other_column, float threshold,
                   const Arithmetic& arithmetic) {
    const auto clamped = [&](int j, int x, int colour) {
        return std::clamp(value_at(image, j, x, colour), 0.0f, 1.0f);
    };
    bool found = false;
    for (int colour = 0; colour < 3; ++colour) {
        const float value = clamped(row, column, colour), other_value = clamped(other_row, other_column, colour);
        found = found || std::abs(arithmetic.subtract(value, other_value)) >= threshold;
    }
    return found;
}

/// Returns a mask: 1 for pixels that differ() from the left, right, upper or lower neighbour, 0 for the others.
inline Image contrast_mask(const Image& image, double threshold, const NumberFormat& format) {
    const Arithmetic arithmetic(format);
    const float rounded = arithmetic.round(threshold);
    return make_image(image.width, image.height, [&](int row, int column, int) {
        constexpr std::array<std::array<int, 2>, 4> kSides = {{{0, -1}, {0, 1}, {-1, 0}, {1, 0}}};
        return float(std::any_of(kSides.begin(), kSides.end(), [&](const auto& side) {
            const int other_row = row + side[0], other_column = column + side[1];
            return inside(image, other_row, other_column) &&
                   differ(image, row, column, other_row, other_column, rounded, arithmetic);
        }));
    });
}

/// Returns the mean of the values of a pixel's own sample point and of its four additional points, added in this order.
inline float mean_of_five(const std::array<float, 5>& values, const NumberFormat& format) {
    const Arithmetic arithmetic(format);
    float sum = values[0];
    for (std::size_t i = 1; i < values.size(); ++i) sum = arithmetic.add(sum, values[i]);
    return arithmetic.divide(sum, 5);
}

/// Returns the number of colour values whose bits differ. If the images' sizes differ, returns the number of values of
/// the larger image.
inline std::size_t count_differences(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height || a.rgb.size() != b.rgb.size())
        return std::max(a.rgb.size(), b.rgb.size());
    std::size_t differences = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i)
        differences += std::bit_cast<std::uint32_t>(a.rgb[i]) != std::bit_cast<std::uint32_t>(b.rgb[i]);
    return differences;
}

}  // namespace raya::whole_image
