// The summary that `raya render` prints.
#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "host/base/json.hpp"
#include "host/model/unit_text.hpp"
#include "host/report/render_report.hpp"

namespace raya {
namespace {

std::string load_line(const std::string& label, const Load& load, const std::string& remark = {}) {
    return fmt::format("{:7} u = {:.3f}, speed-up {:.1f} of {}, efficiency {:.1f} % (modelled cycles{})\n", label,
                       load.imbalance, load.speedup, load.per_pe.size(), 100 * load.efficiency, remark);
}

std::string antialias_lines(const RenderReport& r) {
    if (!r.antialias) return {};
    const Antialiasing& a = *r.antialias;
    std::string text;
    if (!a.points.empty())
        text += fmt::format("super   {} pixels ({:.1f} %) recomputed from 4 more points each, threshold {}\n",
                            a.recomputed, 100 * a.recomputed_share, a.threshold);
    if (r.loads.size() > 1)
        for (const auto& [phase, load] : r.loads) text += load_line("  " + phase.substr(0, 5), load);
    const Communication& c = r.communication;
    if (a.exchange == "bus")
        return text +
               fmt::format("bus     {} between PEs, {} words\n", counted(c.transfers, "transfer"), c.transfer_words);
    if (a.exchange == "bus-broadcast")
        return text + fmt::format("bus     {} by PEs, {} words\n", counted(c.pe_broadcasts, "broadcast"),
                                  c.pe_broadcast_words);
    return text + fmt::format("ring    {}, {} words\n", counted(c.rotations, "rotation"), c.rotation_words);
}

std::string model_line(const RenderReport& r) {
    const ModelledTime& t = r.modelled;
    return fmt::format(
        "model   objects {}, compute {}, communication {}, image {}, display {}: {} (modelled time of {})\n",
        time_text(t.objects_ms), time_text(t.compute_ms), time_text(t.communication_ms), time_text(t.image_ms),
        time_text(t.display_ms), time_text(t.total_ms), r.machine.name);
}

// Returns PEs and mapping of the ring, or nodes and voxels of the torus.
std::string machine_text(const RenderReport& r) {
    if (r.torus) return torus_machine_text(*r.torus);
    return fmt::format("{}, {} mapping{}", counted(r.machine.pes, "PE"), r.machine.mapping,
                       r.machine.offset ? fmt::format(", offset {}", *r.machine.offset) : "");
}

std::string accel_line(const RenderReport& r) {
    if (!r.accel) return {};
    const AccelSummary& a = *r.accel;
    const auto rays = static_cast<double>(ray_count(r.events));
    const std::string tests =
        r.counted ? fmt::format("; {:.1f} tests and {:.1f} {} a ray", static_cast<double>(test_count(r.events)) / rays,
                                static_cast<double>(r.events[RAYA_STEPS]) / rays,
                                a.kind == AccelKind::kBvh ? "nodes" : "steps")
                  : "";
    const std::string separate = a.separate ? fmt::format(", {} listed separately", a.separate) : "";
    if (a.kind == AccelKind::kBvh)
        return fmt::format("bvh     {}, {}, depth {}{}{}\n", counted(a.nodes, "node"),
                           counted(a.leaves, "leaf", "leaves"), a.depth, separate, tests);
    return fmt::format("grid    {}x{}x{} voxels, {} of objects{}{}\n", a.divisions[0], a.divisions[1], a.divisions[2],
                       counted(a.copies, "copy", "copies"), separate, tests);
}

std::string scale_line(const RenderReport& r) {
    if (r.machine.length_exponent == 0) return {};
    return fmt::format("scale   lengths x 2^{}, to fit the range of {}\n", r.machine.length_exponent, r.machine.format);
}

std::string memory_line(const RenderReport& r) {
    return fmt::format("memory  {} in {}{}{}\n", required_size_text(r.machine.pe_memory_used_bytes),
                       r.torus ? "the fullest node" : "each PE",
                       r.machine.pe_memory_bytes ? fmt::format(" of {}", available_size_text(r.machine.pe_memory_bytes))
                                                 : ", no limit",
                       r.torus ? torus_memory_text(*r.torus) : "");
}

// Returns a line with the number and size of the messages of all ranks, and the longest waiting time of a rank.
std::string ranks_line(const RenderReport& r) {
    if (r.ranks.empty()) return {};
    double max_waiting_s = 0;
    std::uint64_t messages = 0, bytes = 0;
    std::set<std::string> hosts;
    for (const Json& rank : r.ranks) {
        max_waiting_s = std::max(max_waiting_s, rank.at("waiting_s").number());
        messages += rank.at("messages_sent").integer();
        bytes += rank.at("bytes_sent").integer();
        hosts.insert(rank.at("host").text());
    }
    return fmt::format("ranks   {} on {}; {}, {} sent; longest wait for other ranks {:.3f} s\n", r.ranks.size(),
                       counted(hosts.size(), "host"), counted(messages, "message"), required_size_text(bytes),
                       max_waiting_s);
}

}  // namespace

std::string summary_text(const RenderReport& r) {
    const EventCounts& e = r.events;
    const std::uint64_t rays = ray_count(e);
    std::string text =
        fmt::format("{}: {} x {} pixels on {} ({}), {}, {}\n", r.scene, r.image.width, r.image.height, r.machine.name,
                    machine_text(r), r.machine.format, counted(r.machine.bounces, "bounce"));
    text += fmt::format("rays    {} = {} primary + {} reflected + {} refracted + {} shadow\n", rays, e[RAYA_PRIMARY],
                        e[RAYA_REFLECTED], e[RAYA_REFRACTED], e[RAYA_SHADOW]);
    if (r.counted) text += load_line("load", r.load, r.requests ? ", simulated" : "");
    text += r.torus ? torus_lines(*r.torus) : antialias_lines(r);
    if (r.counted && !r.torus) text += model_line(r);
    text += accel_line(r) + scale_line(r) + memory_line(r);
    text += fmt::format("time    kernel build {:.2f} s, render {:.3f} s, {} on {} ({})\n", r.measured.build_s,
                        r.measured.render_s, rate_text(static_cast<double>(rays) / r.measured.render_s), r.device.name,
                        counted(r.device.lanes, "lane"));
    const bool tuned_by_file = r.device.tuned != "defaults" && r.device.tuned != "options";
    if (tuned_by_file && !r.device.tuned.empty()) text += fmt::format("tuned   {}\n", r.device.tuned);
    text += ranks_line(r);
    text += fmt::format("image   {} ({})\n", r.image.file, r.image.hash);
    return text;
}

}  // namespace raya
