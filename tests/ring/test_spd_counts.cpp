// Ray counts by kind, compared with the counts that SPD publishes for its scenes. The images have 513 x 513 primary
// rays through pixel corners. A ray tree has up to 5 levels, that of the primary ray included. SPD says:
// "Implementations should agree within about 10 %". The bounds in these tests are tighter: the range of two published
// implementations, extended by 1 % at both ends.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>

#include "host/scene/generate.hpp"
#include "tests/paths.h"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

EventCounts count_rays(const Scene& scene) {
    Session session(choose_device(""));
    RingSettings settings = settings_of(
        {.width = 513, .height = 513, .pes = 513, .offset = 16, .bounces = 4, .sampling = Sampling::kCorners});
    settings.accel.kind = AccelKind::kBvh;
    return RingRenderer(session, scene, settings).render().events;
}

void check_between(std::uint64_t value, double low, double high) {
    CHECK(double(value) >= low);
    CHECK(double(value) <= high);
}

// Returns the path of an output file of the SPD programs. The file may be missing.
std::filesystem::path spd_file(const std::string& name) {
    const char* folder = std::getenv("RAYA_SPD_DIR");
    return std::filesystem::path(folder ? folder : RAYA_SOURCE_DIR "/../shared/spd") / name;
}

}  // namespace

TEST_CASE("the scene balls gives the ray counts that SPD publishes", "[ring]") {
    const EventCounts e = count_rays(generate_balls(4));
    CHECK(e[RAYA_PRIMARY] == 513 * 513);
    CHECK(e[RAYA_PRIMARY_HITS] == 263169);
    check_between(e[RAYA_REFLECTED], 175000, 180500);
    CHECK(e[RAYA_REFRACTED] == 0);
    check_between(e[RAYA_SHADOW], 945000, 969000);
}

TEST_CASE("files written by the SPD programs, if present, give the ray counts that SPD publishes", "[.][long][ring]") {
    if (!std::filesystem::exists(spd_file("tetra.nff"))) {
        WARN("the SPD files are missing: set RAYA_SPD_DIR to a folder with tetra.nff and mount.nff");
        return;
    }
    const EventCounts tetra = count_rays(read_nff(spd_file("tetra.nff")));
    check_between(tetra[RAYA_PRIMARY_HITS], 49788 * 0.99, 49950 * 1.01);
    CHECK(tetra[RAYA_REFLECTED] + tetra[RAYA_REFRACTED] == 0);
    check_between(tetra[RAYA_SHADOW], 46112 * 0.99, 46262 * 1.01);
    const EventCounts mount = count_rays(read_nff(spd_file("mount.nff")));
    check_between(mount[RAYA_PRIMARY_HITS], 173125 * 0.99, 173685 * 1.01);
    check_between(mount[RAYA_REFLECTED] + mount[RAYA_REFRACTED], 709538 * 0.99, 710436 * 1.01);
    check_between(mount[RAYA_SHADOW], 412922 * 0.99, 412922 * 1.01);
}

}  // namespace raya
