// Tests of the stored reference images (reference_images.txt): comparison with new renders on the default device and
// with the double-precision reference renderer.
#include <algorithm>
#include <catch2/catch.hpp>
#include <stdexcept>

#include "host/embedded.hpp"
#include "host/verify/verify.hpp"
#include "tests/reference/reference.hpp"
#include "tests/verify/make_reference_images.hpp"

namespace raya {

// Another test, `tools.verify`, runs `raya verify --quick`, which compares the other images.
TEST_CASE("reference images outside verify --quick equal new renders on the default device", "[verify][slow]") {
    std::size_t compared = 0;
    for (const ReferenceImage& image : reference_images()) {
        CAPTURE(image.name);
        if (!check_ids(choose_device(""), {.only = "image " + image.name + ": "}).empty()) continue;
        CHECK(pixel_hash(render_reference(image)) == stored_image(image).hash);
        Session session(choose_device(""));
        CHECK(counts_by_check_kind(session, image) == stored_image(image).counts);
        ++compared;
    }
    CHECK(compared == 4);
}

TEST_CASE("fp32 reference images agree with the reference renderer within its tolerance", "[verify]") {
    for (const ReferenceImage& image : reference_images()) {
        if (image.format != "fp32" || image.antialias != AntialiasMethod::kNone) continue;
        CAPTURE(image.name);
        const Scene scene = scene_of(image);
        const reference::Options options{.width = static_cast<int>(image.size.width),
                                         .height = static_cast<int>(image.size.height),
                                         .bounces = kReferenceBounces,
                                         .corners = image.sampling == Sampling::kCorners};
        const reference::Difference difference =
            reference::compare(reference::render(scene, options), stored_image(image).image.rgb, scene, options);
        CHECK(difference.psnr_db >= 50);
        CHECK(difference.above_limit == difference.excused);
    }
}

TEST_CASE("parse_reference_images: inverts reference_images_text", "[verify]") {
    const std::string text = embedded_files().at("host/verify/reference_images.txt");
    const std::vector<StoredImage> all = parse_reference_images(text);
    CHECK(all.size() == reference_images().size());
    CHECK(reference_images_text(all) == text);
}

TEST_CASE("parse_reference_images: refuses pixels that do not match the hash", "[verify]") {
    const StoredImage& stored = stored_image(reference_images().front());
    std::string text = reference_images_text({stored});
    CHECK_NOTHROW(parse_reference_images(text));
    text.replace(text.find(stored.hash), 1, stored.hash[0] == '0' ? "1" : "0");
    CHECK_THROWS_AS(parse_reference_images(text), std::logic_error);
}

}  // namespace raya
