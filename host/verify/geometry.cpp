// Rays against objects: hits that are known, and the walk through the grid against testing all objects.
#include <fmt/core.h>

#include "host/verify/hits.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

std::vector<std::string> remedies(const std::vector<std::string>& of_lanes) {
    std::vector<std::string> all = {"are checks of \"number\" wrong too? then those first"};
    all.insert(all.end(), of_lanes.begin(), of_lanes.end());
    all.emplace_back("a newer driver, or another OpenCL implementation for this device (raya devices)");
    return all;
}

void verify_hits(Verification& v, const HitBuild& build) {
    const auto check = [&](const std::string& what, const std::function<Verdict(HitRunner&)>& body) {
        v.check("geometry", fmt::format("{}, {}", what, build.name()), [&](Session& session) {
            HitRunner runner(session, build);
            return with_remedies(body(runner), runner.options(), remedies(v.lanes_remedies(build.lanes)));
        });
    };
    for (const KnownScene& known : known_scenes())
        check("known hits of " + known.name, [&](HitRunner& runner) { return check_known_hits(runner, known); });
    const std::size_t rays = v.depth() == Depth::kBrief ? 128 : 4096;  // in each scene
    if (build.grid)
        check("grid", [&](HitRunner& runner) { return check_walk(runner, {"polygons", "cones", "spheres"}, rays); });
}

}  // namespace

void verify_geometry(Verification& v) {
    for (const std::uint32_t lanes : v.lanes())
        for (const char* format : {"fp32", "spa22"}) {
            HitBuild build{.format = parse_format(format), .lanes = lanes, .sources = v.sources()};
            // The walk computes in fp32 whatever the format is.
            build.grid = v.depth() != Depth::kBrief || build.format.is_fp32();
            verify_hits(v, build);
            if (!v.full() || build.format.is_fp32()) continue;
            HitBuild filtered = build;
            filtered.filter = true;
            verify_hits(v, filtered);
        }
}

}  // namespace raya
