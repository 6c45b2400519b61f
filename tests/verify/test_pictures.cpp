// The known images (pictures.txt), compared with plain renders on the default device and with the reference renderer.
#include <algorithm>
#include <catch2/catch.hpp>
#include <stdexcept>

#include "host/embedded.hpp"
#include "host/verify/verify.hpp"
#include "tests/reference/reference.hpp"
#include "tests/verify/make_pictures.hpp"

namespace raya {

// The test tools.verify runs raya verify --quick, which compares the other known images.
TEST_CASE("known pictures not in verify --quick: equal plain renders of the default device", "[verify][slow]") {
    const std::vector<std::string> quick = check_names(choose_device(""), {.only = "image "});
    std::size_t made = 0;
    for (const Picture& picture : pictures()) {
        CAPTURE(picture.name);
        const std::string beginning = "image " + picture.name + ": ";
        if (std::any_of(quick.begin(), quick.end(), [&](const auto& name) { return name.starts_with(beginning); }))
            continue;
        CHECK(pixel_hash(plain_picture(picture)) == known_picture(picture).hash);
        Session session(choose_device(""));
        CHECK(counts_by_variant(session, picture) == known_picture(picture).counts);
        ++made;
    }
    CHECK(made == 6);
}

TEST_CASE("known pictures in fp32: equal the reference within its tolerance", "[verify]") {
    for (const Picture& picture : pictures()) {
        if (picture.format != "fp32" || picture.antialias != AntialiasMethod::kNone) continue;
        CAPTURE(picture.name);
        const Scene scene = scene_of(picture);
        const reference::Options options{.width = kPictureSide,
                                         .height = kPictureSide,
                                         .bounces = kPictureBounces,
                                         .corners = picture.sampling == Sampling::kCorners};
        const reference::Difference d =
            reference::compare(reference::render(scene, options), known_picture(picture).image.rgb, scene, options);
        CHECK(d.psnr_db >= 50);
        CHECK(d.over == d.excused);
    }
}

TEST_CASE("parse_pictures: inverts pictures_text", "[verify]") {
    const std::string text = embedded_files().at("host/verify/pictures.txt");
    const std::vector<KnownPicture> all = parse_pictures(text);
    CHECK(all.size() == pictures().size());
    CHECK(pictures_text(all) == text);
}

TEST_CASE("parse_pictures: refuses pixels that do not match the hash", "[verify]") {
    const KnownPicture& known = known_picture(pictures().front());
    std::string text = pictures_text({known});
    CHECK_NOTHROW(parse_pictures(text));
    text.replace(text.find(known.hash), 1, known.hash[0] == '0' ? "1" : "0");
    CHECK_THROWS_AS(parse_pictures(text), std::logic_error);
    CHECK_THROWS_AS(parse_pictures("3f8/0/0\n"), std::logic_error);
}

}  // namespace raya
