// Compares an image with the reference, and finds the pixels that rounding may change without an error.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/reference/reference.hpp"

namespace raya::reference {
namespace {

/// Returns the maximum difference of a channel, after clamping to 0..1; infinite if a value is not finite. Adds the
/// squares of the channels' differences to `squares`.
double channel_difference(const Colour& a, const Colour& b, double& squares) {
    double largest = 0;
    for (int i = 0; i < 3; ++i) {
        const bool finite = std::isfinite(a[i]) && std::isfinite(b[i]);
        const double difference = finite ? std::abs(std::clamp(a[i], 0.0, 1.0) - std::clamp(b[i], 0.0, 1.0)) : kFar;
        largest = std::max(largest, difference);
        squares += difference * difference;
    }
    return largest;
}

}  // namespace

bool grazes_edge(const Scene& scene, const Options& options, int x, int y, double edge_distance_pixels) {
    Counts ignored;
    History sample_history;
    const Colour sample = trace_pixel(scene, options, x, y, ignored, &sample_history);
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            History history;
            const Colour colour = trace_pixel(scene, options, x + dx * edge_distance_pixels,
                                              y + dy * edge_distance_pixels, ignored, &history);
            double squares = 0;
            if (history != sample_history || channel_difference(colour, sample, squares) > 1.0 / 255) return true;
        }
    return false;
}

Difference compare(const Image& reference, const std::vector<float>& rgb, const Scene& scene, const Options& options,
                   double limit, double edge_distance_pixels) {
    if (options.width != reference.width || options.height != reference.height ||
        rgb.size() != 3 * reference.pixels.size())
        throw std::invalid_argument("reference::compare: the image, the reference and the options differ in size");
    Difference difference;
    double squares = 0;
    for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
        const Colour colour(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]);
        const double largest = channel_difference(reference.pixels[i], colour, squares);
        difference.largest = std::max(difference.largest, largest);
        if (largest <= limit) continue;
        ++difference.above_limit;
        const int pixel = static_cast<int>(i);
        if (grazes_edge(scene, options, pixel % options.width, pixel / options.width, edge_distance_pixels))
            ++difference.excused;
    }
    difference.psnr_db = -10 * std::log10(squares / static_cast<double>(rgb.size()));
    return difference;
}

}  // namespace raya::reference
