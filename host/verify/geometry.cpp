// Rays against objects: hits that are known, and the walk through the grid against testing all objects.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <optional>

#include "host/embedded.hpp"
#include "host/grid/accel.hpp"
#include "host/scene/nff_reader.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/split_mix.hpp"
#include "host/verify/known_hits.hpp"
#include "host/verify/verify.hpp"
#include "host/verify/words.hpp"

namespace raya {
namespace {

constexpr std::size_t kMostLanes = 16;
constexpr std::size_t kRayWords = 7;

struct Rays {
    std::vector<float> words;  // [ray][kRayWords]: origin, direction, limit

    std::size_t count() const { return words.size() / kRayWords; }
    void add(const std::array<float, 3>& origin, const std::array<float, 3>& direction, float limit) {
        words.insert(words.end(), origin.begin(), origin.end());
        words.insert(words.end(), direction.begin(), direction.end());
        words.push_back(limit);
    }
    void pad() {
        while (count() % kMostLanes) add({0, 0, 0}, {0, 0, 1}, 0);
    }
    std::string text(std::size_t i) const {
        const float* w = &words[i * kRayWords];
        return fmt::format("origin ({:.9g}, {:.9g}, {:.9g}), direction ({:.9g}, {:.9g}, {:.9g}), limit {:.9g}", w[0],
                           w[1], w[2], w[3], w[4], w[5], w[6]);
    }
};

struct Hits {
    std::vector<std::uint32_t> objects, distances;  // [ray]: number or kNothing; bits

    std::string text(std::size_t i) const {
        const std::string t = fmt::format("t 0x{:08x} = {:.9g}", distances[i], std::bit_cast<float>(distances[i]));
        return objects[i] == kNothing ? "nothing, " + t : fmt::format("object {}, {}", objects[i], t);
    }
};

// How the kernels of hits.cl are built.
struct HitBuild {
    NumberFormat format;
    std::uint32_t lanes;
    bool filter;

    std::string name() const {
        return fmt::format("{}{}, {} lane{}", format_name(format), filter ? " filtered" : "", lanes,
                           lanes == 1 ? "" : "s");
    }
};

class HitKernels {
  public:
    HitKernels(const Verification& v, Session& session, const HitBuild& build)
        : verification_(v),
          session_(session),
          lanes_(build.lanes),
          program_(v.build(session, "verify/hits.cl", options(build))) {}

    const std::string& options() const { return program_.options(); }
    std::vector<std::string> lanes_remedies() const { return verification_.lanes_remedies(lanes_); }

    /// By `kernel`, hits_of_all or hits_by_grid, of a job with a grid.
    Hits find(const std::string& kernel, const PackedJob& job, const Rays& rays) {
        auto words = session_.buffer<std::uint32_t>("job", job.words.size());
        auto from = session_.buffer<float>("rays", rays.words.size());
        auto objects = session_.buffer<std::uint32_t>("objects", rays.count());
        auto distances = session_.buffer<std::uint32_t>("distances", rays.count());
        session_.write("job", words, job.words);
        session_.write("rays", from, rays.words);
        session_.fill("objects", objects, kPoison);
        session_.fill("distances", distances, kPoison);
        auto function = program_.kernel<const Buffer<std::uint32_t>&, const Buffer<float>&, Buffer<std::uint32_t>&,
                                        Buffer<std::uint32_t>&>(kernel);
        session_.launch(kernel, function, rays.count() / lanes_, 1, words, from, objects, distances);
        Hits hits{std::vector<std::uint32_t>(rays.count()), std::vector<std::uint32_t>(rays.count())};
        session_.read("objects", objects, hits.objects);
        session_.read("distances", distances, hits.distances);
        return hits;
    }

  private:
    static KernelOptions options(const HitBuild& build) {
        KernelOptions options;
        options.lanes = build.lanes;
        options.format = build.format;
        options.words_local = false;
        options.accel = true;
        options.filter = build.filter;
        return options;
    }

    const Verification& verification_;
    Session& session_;
    std::uint32_t lanes_;
    Program program_;
};

PackedJob job_with_grid(const Scene& scene, const NumberFormat& format) {
    JobSettings settings;
    settings.mapping = {16, 16, 1, 0, RAYA_FOLD_CYCLIC};
    settings.format = format;
    PackedJob job = pack_job(scene, settings);
    append_grid(job, accel_partition(job, format, {.grid = true, .divisions = Divisions{6, 5, 4}}));
    return job;
}

std::vector<std::string> remedies(const std::vector<std::string>& of_lanes) {
    std::vector<std::string> all = {"are checks of \"number\" wrong too? then those first"};
    all.insert(all.end(), of_lanes.begin(), of_lanes.end());
    all.emplace_back("a newer driver, or another OpenCL implementation for this device (raya devices)");
    return all;
}

// The first ray of which `got` differs; `what` says which ray that is.
template <class What>
std::optional<Verdict> first_difference(const Hits& expected, const Hits& got, const Rays& rays, std::size_t count,
                                        const HitKernels& kernels, const What& what) {
    std::size_t wrong = 0, first = 0;
    for (std::size_t i = count; i-- > 0;) {
        if (got.objects[i] == expected.objects[i] && got.distances[i] == expected.distances[i]) continue;
        ++wrong;
        first = i;
    }
    if (wrong == 0) return {};
    return failed(fmt::format("{} of {} rays wrong", wrong, count),
                  {.where = fmt::format("{}\n{}", what(first), rays.text(first)),
                   .expected = expected.text(first),
                   .got = got.text(first),
                   .options = kernels.options(),
                   .remedies = remedies(kernels.lanes_remedies())});
}

Verdict check_known_hits(HitKernels& kernels, const KnownScene& known, const HitBuild& build) {
    const PackedJob job = job_with_grid(known.scene, build.format);
    Rays rays;
    Hits expected;
    for (const KnownHit& hit : known.hits) {
        rays.add(hit.origin, hit.direction, hit.limit);
        expected.objects.push_back(hit.object);
        expected.distances.push_back(std::bit_cast<std::uint32_t>(hit.object == kNothing ? hit.limit : hit.t));
    }
    rays.pad();
    for (const char* kernel : {"hits_of_all", "hits_by_grid"}) {
        const Hits got = kernels.find(kernel, job, rays);
        const auto what = [&](std::size_t i) {
            return fmt::format("{}: {} ({})", known.name, known.hits[i].what, kernel);
        };
        if (auto verdict = first_difference(expected, got, rays, known.hits.size(), kernels, what)) return *verdict;
    }
    return passed(fmt::format("{} rays, with and without grid", known.hits.size()));
}

// From around the scene towards its middle, with a direction that is normalised as well as the format can.
Rays random_rays(const NumberFormat& format, double extent, std::size_t count) {
    constexpr std::uint64_t kSeed = 1986;
    SplitMix random(kSeed);
    const auto rounded = [&](double x) {
        return format.is_fp32() ? static_cast<float>(x) : round_to_format(x, format);
    };
    Rays rays;
    for (std::size_t i = 0; i < count; ++i) {
        std::array<float, 3> origin{}, direction{};
        Vec3 to{};
        for (int axis = 0; axis < 3; ++axis) {
            origin[std::size_t(axis)] = rounded(random.uniform(-extent, extent) * (i % 3 == 0 ? 0.3 : 1));
            to[axis] = random.uniform(-0.3, 0.3) * extent - origin[std::size_t(axis)];
        }
        to.normalize();
        for (int axis = 0; axis < 3; ++axis) direction[std::size_t(axis)] = rounded(to[axis]);
        rays.add(origin, direction, kUsualLimit);
    }
    return rays;
}

// What the grid finds must be what testing all objects finds, on the same device: the walk decides nothing.
Verdict check_walk(HitKernels& kernels, const HitBuild& build) {
    constexpr std::size_t kRays = 4096;
    std::size_t struck = 0;
    for (const char* name : {"polygons", "cones", "spheres"}) {
        const std::string file = fmt::format("scenes/{}.nff", name);
        const Scene scene = parse_nff(embedded_files().at(file), file);
        const PackedJob job = job_with_grid(scene, build.format);
        const Rays rays = random_rays(build.format, scene_extent(scene), kRays);
        const Hits all = kernels.find("hits_of_all", job, rays), walked = kernels.find("hits_by_grid", job, rays);
        const auto what = [&](std::size_t i) { return fmt::format("ray {} through {}, by the grid", i, file); };
        if (auto verdict = first_difference(all, walked, rays, kRays, kernels, what)) return *verdict;
        for (const std::uint32_t object : all.objects) struck += object != kNothing;
    }
    if (struck < kRays) return failed(fmt::format("only {} of {} rays hit anything", struck, 3 * kRays), {});
    return passed(fmt::format("{} rays, {} hits, with and without grid", 3 * kRays, struck));
}

void verify_hits(Verification& v, const HitBuild& build) {
    for (const KnownScene& known : known_scenes())
        v.check("geometry", fmt::format("known hits of {}, {}", known.name, build.name()), [&](Session& session) {
            HitKernels kernels(v, session, build);
            return check_known_hits(kernels, known, build);
        });
    v.check("geometry", fmt::format("grid, {}", build.name()), [&](Session& session) {
        HitKernels kernels(v, session, build);
        return check_walk(kernels, build);
    });
}

}  // namespace

void verify_geometry(Verification& v) {
    for (const std::uint32_t lanes : v.lanes())
        for (const char* format : {"fp32", "spa22"}) {
            verify_hits(v, {parse_format(format), lanes, false});
            if (v.full() && std::string(format) != "fp32") verify_hits(v, {parse_format(format), lanes, true});
        }
}

}  // namespace raya
