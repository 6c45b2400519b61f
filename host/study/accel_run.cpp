#include "host/study/accel_run.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "host/error.hpp"
#include "host/image/image.hpp"
#include "host/model/accel.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/nff_writer.hpp"
#include "host/study/embree_peer.hpp"
#include "host/study/peer.hpp"

namespace raya {
namespace {

constexpr int kPeerSamples = 3;  // a turn of Embree: its samples are single pictures, however short

AccelKind kind_of(const std::string& way) {
    return way == kBvhWay ? AccelKind::kBvh : way == kGridWay ? AccelKind::kGrid : AccelKind::kNone;
}

RingSettings ring_settings(const AccelSettings& settings, AccelKind kind) {
    const std::uint32_t tile = tile_side(settings.side);
    RingSettings ring;
    ring.machine = machine_named("grande");
    ring.mapping = make_mapping(tiles_mapping(tile, tile), {settings.side, settings.side}, settings.side);
    ring.bounces = settings.bounces;
    ring.accel.kind = kind;
    return ring;
}

AccelRun run_of(const AccelScene& scene, const Scene& made, const std::string& way) {
    AccelRun run;
    run.series = scene.series;
    run.group = scene.group;
    run.seed = scene.seed;
    run.way = way;
    run.objects = made.object_count();
    return run;
}

}  // namespace

std::uint32_t tile_side(std::uint32_t image_side) { return std::gcd(image_side, 16u); }

// A way that is ready, and how to take a turn of it.
struct AccelBench::Way {
    AccelRun run;
    std::function<std::vector<double>()> turn;  // seconds of one image, of each sample
    std::string hash = {};                      // of the image; Embree's is not compared
    std::vector<double> seconds = {};

    bool has_enough(double enough_s) const { return std::accumulate(seconds.begin(), seconds.end(), 0.0) >= enough_s; }
};

AccelBench::AccelBench(Session& session, const AccelSettings& settings,
                       const std::optional<std::filesystem::path>& peer)
    : session_(session), settings_(settings), peer_(peer) {
    runs_.has_peer = peer.has_value();
}

AccelBench::Way AccelBench::prepared(const AccelScene& scene, const Scene& made, const std::string& name) const {
    const auto renderer = std::make_shared<RingRenderer>(session_, made, ring_settings(settings_, kind_of(name)));
    const RingResult first = renderer->render();
    Way way{run_of(scene, made, name),
            [renderer] { return std::vector{sample_seconds([&] { return renderer->render().render_s; })}; },
            pixel_hash(first.image)};
    way.run.rays = ray_count(first.all.events);
    way.run.events = first.all.events;
    way.run.accel_words = first.accel ? first.accel->words : 0;
    way.run.scene_words = first.pe_memory.job_words - way.run.accel_words;
    way.run.build_ms = 1e3 * first.accel_s;
    return way;
}

// Raya's: the one without an accelerator first, where it can be borne.
std::vector<AccelBench::Way> AccelBench::ways_of(const AccelScene& scene, const Scene& made) {
    std::vector<Way> ways;
    for (const char* name : {kGridWay, kBvhWay}) ways.push_back(prepared(scene, made, name));
    const AccelRun& known = ways.front().run;
    const double predicted_s = test_s_ * static_cast<double>(known.rays) * static_cast<double>(known.objects);
    if (predicted_s > settings_.bearable_s)
        runs_.left_out.push_back({scene.group, known.objects, predicted_s});
    else
        ways.insert(ways.begin(), prepared(scene, made, kNoAccel));
    for (const Way& way : ways)
        if (way.hash != ways.front().hash || way.run.rays != ways.front().run.rays)
            throw DeviceError(fmt::format(
                "{}: --accel {} gives another image than {}: {} and {}; the device or its compiler is wrong",
                scene.group, way.run.way, ways.front().run.way, way.hash, ways.front().hash));
    return ways;
}

// None where Embree is not there or refuses the scene.
std::optional<AccelBench::Way> AccelBench::peer_way(const AccelScene& scene, const Scene& made) {
    if (!peer_) return {};
    try {
        const auto nff = std::make_shared<std::string>(write_nff(made));
        const PeerPicture picture{settings_.side, settings_.bounces, kPeerSamples};
        const PeerAnswer first = ask_embree(*peer_, *nff, picture);
        const auto best = [](const PeerWay& way) { return *std::ranges::min_element(way.seconds); };
        const PeerWay fastest = *std::ranges::min_element(first.ways, {}, best);
        Way way{run_of(scene, made, kEmbreeWay), [=, program = *peer_] {
                    for (PeerWay& one : ask_embree(program, *nff, picture).ways)
                        if (one.name == fastest.name) return one.seconds;
                    throw PeerFailure("embree_peer: it leaves out " + fastest.name);
                }};
        way.run.rays = fastest.rays;
        way.run.build_ms = 1e3 * first.build_s;
        return way;
    } catch (const UserError& failure) {  // of the program, or of a scene that NFF cannot express
        runs_.peer_failures.push_back(scene.group + ": " + failure.what());
    }
    return {};
}

// One sample of each after another, so that a disturbance from outside hits all of them alike.
void AccelBench::take_turns(std::vector<Way>& ways) const {
    for (int round = 0; round < settings_.rounds; ++round)
        for (Way& way : ways) {
            if (round > 0 && way.has_enough(settings_.enough_s)) continue;
            const std::vector<double> seconds = way.turn();
            way.run.turns_ms.push_back(1e3 * *std::ranges::min_element(seconds));
            way.seconds.insert(way.seconds.end(), seconds.begin(), seconds.end());
        }
}

void AccelBench::measure(const AccelScene& scene) {
    const Scene made = scene.make();
    std::vector<Way> ways = ways_of(scene, made);
    if (std::optional<Way> peer = peer_way(scene, made)) ways.push_back(std::move(*peer));
    take_turns(ways);
    for (Way& way : ways) {
        way.run.time = measured_of(std::move(way.seconds));
        if (way.run.way == kNoAccel)
            test_s_ = 1e-3 * way.run.time.min_ms / static_cast<double>(way.run.rays * way.run.objects);
        runs_.runs.push_back(way.run);
    }
}

}  // namespace raya
