#include "host/verify/hits.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include "host/accel/partition.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/embedded.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/split_mix.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

// Options with which kernels/checks/hits.cl is built.
struct HitBuild {
    NumberFormat format;
    std::uint32_t lanes = 1;
    bool filter = false;  // use the sphere filter
    bool grid = true;     // false: leave out the grid traversal, which takes most of the build time
    KernelSources sources{};

    // Returns text such as "e6m15 filtered".
    std::string name() const { return format_name(format) + (filter ? " filtered" : ""); }
};

CheckRunner hit_runner(Session& session, const HitBuild& build) {
    KernelOptions options;
    options.lanes = build.lanes;
    options.format = build.format;
    options.words_local = false;
    options.accel = build.grid ? RAYA_ACCEL_GRID : RAYA_ACCEL_NONE;
    options.filter = build.filter;
    return {session, Kernels(session, options, build.sources).program("checks/hits.cl"), build.lanes};
}

PackedJob job_with_grid(const Scene& scene, const NumberFormat& format) {
    PackedJob job = pack_job(scene, {.image = {16, 16}, .format = format});
    append_grid(job, accel_partition(job, format, {.kind = AccelKind::kGrid, .divisions = Divisions{6, 5, 4}}));
    return job;
}

// Returns a point on the outline of a random sphere or polygon of the scene, as it is seen from `eye`.
Vec3 random_outline_point(SplitMix& random, const Scene& scene, const Vec3& eye) {
    const auto below = [&](std::size_t end) { return static_cast<std::size_t>(random.uniform(0, double(end))); };
    const std::size_t i = below(scene.spheres.size() + scene.polygons.size());
    if (i < scene.spheres.size()) {
        const Sphere& s = scene.spheres[i];
        const Vec3 to_eye = (eye - s.centre).normalized();
        const Vec3 aside = to_eye.cross({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
        return s.centre + std::abs(s.radius) * aside.normalized();
    }
    const std::vector<Vec3>& corners = scene.polygons[i - scene.spheres.size()].vertices;
    const std::size_t k = below(corners.size());
    return corners[k] + random.uniform(0, 1) * (corners[(k + 1) % corners.size()] - corners[k]);
}

// Returns `count` rays from random points in and around the scene, to outlines of objects or to random points near the
// centre of the scene. Directions have length 1. All numbers are rounded to the format.
Rays random_rays(const NumberFormat& format, const Scene& scene, std::size_t count, bool to_outlines) {
    constexpr std::uint64_t kSeed = 1986;
    SplitMix random(kSeed);
    const double extent = scene_extent(scene);
    const auto random_point = [&](double range) {
        return Vec3{random.uniform(-range, range), random.uniform(-range, range), random.uniform(-range, range)};
    };
    const auto rounded = [&](const Vec3& v) {
        std::array<float, 3> all{};
        for (int axis = 0; axis < 3; ++axis)
            all[std::size_t(axis)] = format.is_fp32() ? static_cast<float>(v[axis]) : round_to_format(v[axis], format);
        return all;
    };
    Rays rays;
    for (std::size_t i = 0; i < count; ++i) {
        const std::array<float, 3> origin = rounded(random_point(i % 3 == 0 ? 0.3 * extent : extent));
        const Vec3 start(origin[0], origin[1], origin[2]);
        const Vec3 target = to_outlines ? random_outline_point(random, scene, start) : random_point(0.3 * extent);
        rays.add(origin, rounded((target - start).normalized()), kDefaultRayLimit);
    }
    return rays;
}

// Compares the hits of all rays. `describe(ray)` returns the description of a ray. If all hits are equal, the verdict
// is a pass with the text `pass_text`; else it states the number of rays with a wrong hit, and the details of the first
// such ray.
Verdict compare_hits(const Hits& expected, const Hits& got, const Rays& rays,
                     const std::function<std::string(std::size_t)>& describe, const std::string& pass_text) {
    std::size_t wrong_rays = 0, first_wrong = 0;
    for (std::size_t i = rays.count(); i-- > 0;) {
        if (got.objects[i] == expected.objects[i] && got.distances[i] == expected.distances[i]) continue;
        ++wrong_rays;
        first_wrong = i;
    }
    if (wrong_rays == 0) return passed(pass_text);
    report_expected("objects", KnownWords(expected.objects));
    report_expected("distances", KnownWords(expected.distances));
    return failed(fmt::format("{} of {} rays wrong", wrong_rays, rays.count()),
                  {.where = fmt::format("{}\n{}", describe(first_wrong), rays.text(first_wrong)),
                   .expected = expected.text(first_wrong),
                   .got = got.text(first_wrong)});
}

// Reads rays and their hits from the lines "#hit ORIGIN DIRECTION OBJECT T LIMIT DESCRIPTION" of a scene; OBJECT is -
// for a miss. Returns the descriptions.
std::vector<std::string> read_known_hits(const std::string& text, Rays& rays, Hits& hits) {
    std::vector<std::string> descriptions;
    std::istringstream lines(text);
    for (std::string line, object; std::getline(lines, line);) {
        if (!line.starts_with("#hit ")) continue;
        std::istringstream in(line.substr(5));
        std::array<float, 3> origin{}, direction{};
        for (auto* vector : {&origin, &direction})
            for (float& number : *vector) in >> number;
        float t = 0, limit = 0;
        in >> object >> t >> limit >> std::ws;
        rays.add(origin, direction, limit);
        hits.objects.push_back(object == "-" ? kNoObject : static_cast<std::uint32_t>(std::stoul(object)));
        hits.distances.push_back(std::bit_cast<std::uint32_t>(object == "-" ? limit : t));
        std::getline(in, descriptions.emplace_back());
    }
    return descriptions;
}

// Checks that each kernel in the build finds the hits of host/verify/known_NAME.nff, which are calculated by hand: from
// outside and inside, tangents, misses and equal distances.
Verdict check_known_hits(CheckRunner& runner, const HitBuild& build, const std::string& name) {
    const std::string file = fmt::format("host/verify/known_{}.nff", name);
    Scene scene = parse_nff(embedded_files().at(file), file);
    // A quadrilateral that is not planar, which the reader would cut into triangles.
    if (name == "polygons") scene.polygons.push_back({{{200, 0, 12}, {200, 8, 20}, {192, 8, 12}, {192, 0, 20}}, {}, 0});
    Rays rays;
    Hits expected;
    std::vector<std::string> descriptions = read_known_hits(embedded_files().at(file), rays, expected);
    const std::string text = fmt::format("{} rays, {}without grid", descriptions.size(), build.grid ? "with and " : "");
    rays.pad();
    expected.objects.resize(rays.count(), kNoObject);
    expected.distances.resize(rays.count());  // equal to the limit
    descriptions.resize(rays.count(), "a ray of limit 0");
    const PackedJob job = job_with_grid(scene, build.format);
    std::vector<const char*> kernels = {"hits_without_accel"};
    if (build.grid) kernels.push_back("hits_with_accel");
    for (const char* const kernel : kernels) {
        const auto describe = [&](std::size_t i) { return fmt::format("{}: {} ({})", name, descriptions[i], kernel); };
        const Verdict verdict =
            compare_hits(expected, find_hits(runner, kernel, job.words(), rays), rays, describe, text);
        if (verdict.outcome != Outcome::kPass) return verdict;
    }
    return passed(text);
}

// A kernel that finds hits.
struct HitFinder {
    CheckRunner& runner;
    std::string kernel;
};

// Checks that `tested` finds the same hits as `reference` for `rays_per_scene` random rays in each scene.
Verdict compare_finders(const NumberFormat& format, const HitFinder& reference, const HitFinder& tested,
                        const std::string& difference, const std::vector<std::string>& scenes,
                        std::size_t rays_per_scene, bool to_outlines) {
    std::size_t hits = 0;
    for (const std::string& name : scenes) {
        const std::string file = fmt::format("scenes/{}.nff", name);
        const Scene scene = parse_nff(embedded_files().at(file), file);
        const PackedJob job = job_with_grid(scene, format);
        const Rays rays = random_rays(format, scene, rays_per_scene, to_outlines);
        const Hits expected = find_hits(reference.runner, reference.kernel, job.words(), rays);
        const Hits got = find_hits(tested.runner, tested.kernel, job.words(), rays);
        const auto describe = [&](std::size_t i) {
            return fmt::format("ray {} through {}, with {}", i, file, difference);
        };
        const Verdict verdict = compare_hits(expected, got, rays, describe, "");
        if (verdict.outcome != Outcome::kPass) return verdict;
        for (const std::uint32_t object : expected.objects) hits += object != kNoObject;
    }
    const std::size_t rays = scenes.size() * rays_per_scene;
    if (hits < rays_per_scene) return failed(fmt::format("only {} of {} rays hit an object", hits, rays), {});
    return passed(fmt::format("{} rays, {} hits, with and without {}", rays, hits, difference));
}

// Checks the error bounds of the filters. Aimed rays rarely show that a bound is too small.
Verdict check_filter_bounds(CheckRunner& runner, const NumberFormat& format) {
    const double unit = std::ldexp(format.truncates ? 1 : 0.5, -format.fraction_bits) + 0x1p-24;
    const double room = std::ldexp(1, (1 << (format.exponent_bits - 2)) - 2);
    std::vector<std::uint32_t> expected;
    for (const double bound : {unit, smallest_number(format), room})
        expected.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(bound)));
    auto bounds = runner.poisoned("bounds", expected.size());
    runner.run<Buffer<std::uint32_t>&>("filter_bounds", 1, 1, bounds);
    const std::vector<std::uint32_t> got = runner.read(bounds);
    if (got == expected) return passed("error bounds");
    report_expected("bounds", KnownWords(expected));
    return failed("wrong error bounds of the filters", {.where = "RAYA_ERROR, RAYA_FLUSH, RAYA_ROOM",
                                                        .expected = fmt::format("0x{:08x}", fmt::join(expected, " 0x")),
                                                        .got = fmt::format("0x{:08x}", fmt::join(got, " 0x"))});
}

// Adds the checks of one build: known hits; the hits of random rays with and without grid, and with and without
// filters, if the build has them. Their names end in `lanes_text`.
void verify_hits(Verification& v, const HitBuild& build, const std::string& lanes_text) {
    const auto check = [&](const std::string& subject, const std::function<Verdict(CheckRunner&, Session&)>& body) {
        v.check("geometry", fmt::format("{}, {}{}", subject, build.name(), lanes_text), [&](Session& session) {
            CheckRunner runner = hit_runner(session, build);
            return with_options(body(runner, session), runner.options());
        });
    };
    for (const char* const name : {"spheres", "planes", "polygons", "cones"})
        check(std::string("known hits of ") + name,
              [&](CheckRunner& runner, Session&) { return check_known_hits(runner, build, name); });
    const std::size_t rays_per_scene = v.settings().depth == Depth::kBrief ? 128 : 4096;
    if (build.grid)
        check("grid", [&](CheckRunner& runner, Session&) {
            return compare_finders(build.format, {runner, "hits_without_accel"}, {runner, "hits_with_accel"}, "grid",
                                   {"polygons", "cones", "spheres"}, rays_per_scene, false);
        });
    if (build.filter)
        check("filters", [&](CheckRunner& filtered, Session& session) {
            const Verdict bounds = check_filter_bounds(filtered, build.format);
            if (bounds.outcome != Outcome::kPass) return bounds;
            HitBuild without = build;
            without.filter = false;
            CheckRunner reference = hit_runner(session, without);
            return compare_finders(build.format, {reference, "hits_without_accel"}, {filtered, "hits_without_accel"},
                                   "filters", {"polygons", "spheres"}, rays_per_scene, true);
        });
}

}  // namespace

void Rays::add(const std::array<float, 3>& origin, const std::array<float, 3>& direction, float limit) {
    words.insert(words.end(), origin.begin(), origin.end());
    words.insert(words.end(), direction.begin(), direction.end());
    words.push_back(limit);
}

void Rays::pad() {
    while (count() % kMaxLanes != 0) add({0, 0, 0}, {0, 0, 1}, 0);
}

std::string Rays::text(std::size_t ray) const {
    const float* ray_words = &words[ray * kWords];
    return fmt::format("origin ({:.9g}, {:.9g}, {:.9g}), direction ({:.9g}, {:.9g}, {:.9g}), limit {:.9g}",
                       ray_words[0], ray_words[1], ray_words[2], ray_words[3], ray_words[4], ray_words[5],
                       ray_words[6]);
}

std::string Hits::text(std::size_t ray) const {
    const std::string t = fmt::format("t 0x{:08x} = {:.9g}", distances[ray], std::bit_cast<float>(distances[ray]));
    return objects[ray] == kNoObject ? "nothing, " + t : fmt::format("object {}, {}", objects[ray], t);
}

Hits find_hits(CheckRunner& runner, const std::string& kernel, const std::vector<std::uint32_t>& job,
               const Rays& rays) {
    const auto job_words = runner.filled("job", job);
    const auto ray_words = runner.filled("rays", rays.words);
    auto objects = runner.poisoned("objects", rays.count()), distances = runner.poisoned("distances", rays.count());
    runner.run_rows<const Buffer<std::uint32_t>&, const Buffer<float>&, Buffer<std::uint32_t>&, Buffer<std::uint32_t>&>(
        kernel, rays.count(), job_words, ray_words, objects, distances);
    return {runner.read(objects), runner.read(distances)};
}

void verify_geometry(Verification& v) {
    for (const std::uint32_t lanes : v.lanes())
        for (const char* format : {"fp32", "spa22"}) {
            HitBuild build{.format = parse_format(format), .lanes = lanes, .sources = v.settings().sources};
            // The grid traversal computes in fp32 in every format, so a brief verification checks it only in fp32.
            build.grid = v.settings().depth != Depth::kBrief || build.format.is_fp32();
            verify_hits(v, build, v.lanes_text(lanes));
            if (!v.full() || build.format.is_fp32()) continue;
            HitBuild filtered = build;
            filtered.filter = true;
            verify_hits(v, filtered, v.lanes_text(lanes));
        }
    if (v.full())  // the filters' error bounds in a format that truncates
        verify_hits(v,
                    {.format = parse_format("e8m12t"),
                     .lanes = v.lanes_or_default(),
                     .filter = true,
                     .grid = false,
                     .sources = v.settings().sources},
                    "");
}

}  // namespace raya
