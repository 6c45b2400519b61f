// Makes the known images, with their hashes and event counts, by renders with the plain settings on the default device.
#pragma once
#include <string>
#include <vector>

#include "host/ring/ring_renderer.hpp"
#include "host/verify/pictures.hpp"

namespace raya {

inline Image plain_picture(const Picture& picture) {
    Session session(choose_device(""));
    return RingRenderer(session, scene_of(picture), reference_settings(picture)).render().image;
}

/// Returns the text of host/verify/pictures.txt.
inline std::string make_pictures() {
    std::vector<KnownPicture> all;
    for (const Picture& picture : pictures()) {
        const Image image = plain_picture(picture);
        Session session(choose_device(""));
        all.push_back({picture.name, pixel_hash(image), image, counts_by_variant(session, picture)});
    }
    return pictures_text(all);
}

}  // namespace raya
