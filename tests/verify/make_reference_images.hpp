// Renders the reference images with reference_settings() on the default device, and makes the text of
// reference_images.txt.
#pragma once
#include <string>
#include <vector>

#include "host/ring/ring_renderer.hpp"
#include "host/verify/reference_images.hpp"

namespace raya {

inline Image render_reference(const ReferenceImage& image) {
    Session session(choose_device(""));
    return RingRenderer(session, scene_of(image), reference_settings(image)).render().image;
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
