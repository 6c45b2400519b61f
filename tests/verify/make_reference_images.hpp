// Renders the reference images with reference_settings() on the default device, and makes the text of
// reference_images.txt.
#pragma once
#include <fmt/core.h>

#include <bit>
#include <string>
#include <vector>

#include "host/ring/ring_renderer.hpp"
#include "host/verify/reference_images.hpp"
#include "tests/verify/digits.hpp"

namespace raya {

inline Image render_reference(const ReferenceImage& image) {
    Session session(choose_device(""));
    return RingRenderer(session, scene_of(image), reference_settings(image)).render().image;
}

inline std::string colour_text(const float* rgb) {
    const auto digits = [&](std::size_t k) { return digits_of(std::bit_cast<std::uint32_t>(rgb[k])); };
    return digits(0) + '/' + digits(1) + '/' + digits(2);
}

/// Inverse of parse_reference_images().
inline std::string reference_images_text(const std::vector<StoredImage>& all) {
    std::string text =
        R"(# Hashes, counts and pixels of the reference images, made by tests/verify/make_reference_images.cpp: do not edit.
# An image has a line "NAME: HASH", lines "counts KIND: COUNTER NUMBER ...", and a line for each row of pixels.
# A pixel is RED/GREEN/BLUE, bits of fp32 numbers in hexadecimal without trailing zeros; "." repeats the pixel to the
# left, "=" the pixel at the same position in the previous image.
)";
    std::vector<std::string> previous;
    for (const StoredImage& stored : all) {
        const auto width = static_cast<std::size_t>(stored.image.width);
        previous.resize(stored.image.rgb.size() / 3);
        text += fmt::format("{}: {}\n", stored.name, stored.hash);
        for (const auto& [kind, counts] : stored.counts) text += fmt::format("counts {}: {}\n", kind, counts);
        std::string left;
        for (std::size_t i = 0; i < previous.size(); ++i) {
            const std::string pixel = colour_text(&stored.image.rgb.at(3 * i));
            const bool first = i % width == 0, last = (i + 1) % width == 0;
            text += (pixel == left && !first ? "." : pixel == previous[i] ? "=" : pixel) + (last ? "\n" : " ");
            left = previous[i] = pixel;
        }
    }
    return text;
}

/// Returns the text of host/verify/reference_images.txt.
inline std::string make_reference_images() {
    std::vector<StoredImage> all;
    for (const ReferenceImage& image : reference_images()) {
        const Image pixels = render_reference(image);
        Session session(choose_device(""));
        all.push_back({image.name, pixel_hash(pixels), pixels, counts_by_check_kind(session, image)});
    }
    return reference_images_text(all);
}

}  // namespace raya
