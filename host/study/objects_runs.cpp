#include "host/study/objects_runs.hpp"

#include <cmath>
#include <set>

#include "host/scene/spread.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSides = kObjectSides;  // nodes along each axis too
constexpr std::array<Protocol, 2> kProtocols = {kProtocolOfPaper, kProtocolOfRaya};
constexpr std::uint32_t kOtherWords[] = {32, 48};  // beside the paper's least

TorusPlan plan_of(const Protocol& protocol) {
    TorusPlan plan;
    plan.nodes = plan.voxels = {kSides, kSides, kSides};
    plan.links = Links::kTorus2d;
    plan.bounces = 0;
    plan.inject = protocol.inject;
    plan.packets = protocol.packets;
    return plan;
}

// Without lights there are no shadow rays, and every event is a primary ray's.
void add_primary_rays(PrimaryRow& row, Session& session, Scene scene, std::uint32_t size) {
    scene.lights.clear();
    std::set<std::uint32_t> gone_on;  // pixels whose rays left the voxel by which they came in
    const TorusRun run =
        run_on_torus(session, {scene.name, scene}, size, plan_of(kProtocolOfRaya), [&](const PacketRecord& record) {
            if (raya_state_kind(record.head.state) == RAYA_KIND_PRIMARY) gone_on.insert(record.head.pixel);
        });
    const EventCounts& e = run.result.events;
    const double walks = std::max(1.0, static_cast<double>(e[RAYA_WALKS]));
    row.hit_shares.push_back(static_cast<double>(e[RAYA_PRIMARY_HITS]) / static_cast<double>(e[RAYA_PRIMARY]));
    row.first_shares.push_back(1 - static_cast<double>(gone_on.size()) / walks);
    row.voxels.push_back(run.steps() / walks);
}

// The scenes of one number of objects: the even one, and of each seed one drawn at random and the same moved within.
struct Drawn {
    Scene even;
    std::vector<Scene> random = {}, within = {};
};

Drawn drawn(int objects, int seeds) {
    const Scene scene = moved_within(even_scene(objects).scene);
    Drawn all{touching_walls(scene)};
    for (int seed = 1; seed <= seeds; ++seed) {
        const Scene one = scattered(scene, static_cast<std::uint64_t>(seed));
        all.random.push_back(touching_walls(one));
        all.within.push_back(touching_walls(moved_within(one)));
    }
    return all;
}

double log_ratio(double a, double b) { return std::log(a) / std::log(b); }

}  // namespace

ObjectsRuns run_objects(Session& session, const std::vector<int>& counts, std::uint32_t size, int seeds) {
    ObjectsRuns all;
    for (const int count : counts) {
        const Drawn scenes = drawn(count, seeds);
        for (const Protocol& protocol : kProtocols) {
            const auto row = [&](const char* kind, const std::vector<Scene>& some) {
                all.rows.push_back({count, kind, protocol.name});
                TorusPlan plan = plan_of(protocol);
                plan.asynchronous = true;
                for (const Scene& scene : some)
                    all.rows.back().runs.push_back(run_on_torus(session, {scene.name, scene}, size, plan));
            };
            row(kEven, {scenes.even});
            row(kRandom, scenes.random);
            row(kWithin, scenes.within);
        }
        all.primary.push_back({count, kEven});
        add_primary_rays(all.primary.back(), session, scenes.even, size);
        all.primary.push_back({count, kRandom});
        for (const Scene& scene : scenes.random) add_primary_rays(all.primary.back(), session, scene, size);
        if (count != counts.front() && count != counts.back()) continue;
        for (const std::uint32_t words : kOtherWords) {
            TorusPlan plan = plan_of(kProtocolOfPaper);
            plan.packets.ray_words = words;
            const TorusRun run = run_on_torus(session, {scenes.even.name, scenes.even}, size, plan);
            all.words.push_back({count, words, run.overlapped_ms(), run.stepwise_ms()});
        }
    }
    return all;
}

double Growth::share(double factor) const { return log_ratio(factor, sublinearity()); }

Growth growth_of(const TorusRun& first, const TorusRun& last, double objects) {
    const double steps = last.steps() / first.steps();
    const double tests = static_cast<double>(last.tests()) / static_cast<double>(first.tests());
    const double work = last.work_ms() / first.work_ms(), time = last.overlapped_ms() / first.overlapped_ms();
    return {objects, time, 1 / steps, objects * steps / tests, tests / work, work / time};
}

std::vector<Growth> growth_of(const ObjectsRow& first, const ObjectsRow& last) {
    std::vector<Growth> all;
    for (std::size_t i = 0; i < first.runs.size(); ++i)
        all.push_back(growth_of(first.runs[i], last.runs.at(i), static_cast<double>(last.objects) / first.objects));
    return all;
}

ObjectsRows of(const ObjectsRows& rows, const std::string& kind, const std::string& protocol) {
    return where(rows, [&](const ObjectsRow& row) { return row.kind == kind && row.protocol == protocol; });
}

ObjectsRatios ratios_of(const ObjectsRows& rows) {
    ObjectsRatios all;
    for (const std::string protocol : {kPaperProtocol, kOwnProtocol})
        for (const std::string kind : {kRandom, kWithin}) {
            const ObjectsRows even = of(rows, kEven, protocol), some = of(rows, kind, protocol);
            for (std::size_t i = 0; i < some.size(); ++i) {
                const TorusRun& one = even[i].runs.front();
                const auto over = [&](auto time) {
                    return some[i].of(
                        [&](const TorusRun& run) { return std::invoke(time, run) / std::invoke(time, one); });
                };
                all.push_back({some[i].objects, kind, protocol, over(&TorusRun::overlapped_ms),
                               over(&TorusRun::stepwise_ms), over(&TorusRun::asynchronous_ms)});
            }
        }
    return all;
}

ObjectsRatios of(const ObjectsRatios& all, const std::string& kind, const std::string& protocol) {
    return where(all, [&](const ObjectsRatio& one) { return one.kind == kind && one.protocol == protocol; });
}

std::vector<GrowthRow> growth_rows(const ObjectsRows& rows) {
    std::vector<GrowthRow> all;
    for (const std::string protocol : {kPaperProtocol, kOwnProtocol})
        for (const std::string kind : {kEven, kRandom}) {
            const ObjectsRows some = of(rows, kind, protocol);
            all.push_back({kind, protocol, growth_of(some.front(), some.back())});
        }
    return all;
}

}  // namespace raya
