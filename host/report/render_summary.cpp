// The summary that `raya render` prints.
#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "host/base/json.hpp"
#include "host/model/number_format.hpp"
#include "host/report/render_report.hpp"

namespace raya {
namespace {

std::string machine_text(const RenderReport& r) {
    if (!r.of_machine.title.empty()) return r.of_machine.title;
    return fmt::format("{}, {} mapping{}", counted(r.machine.pes, "PE"), r.machine.mapping,
                       r.machine.offset ? fmt::format(", offset {}", *r.machine.offset) : "");
}

std::string scale_line(const RenderReport& r) {
    if (r.machine.length_exponent == 0) return {};
    return fmt::format("scale   lengths x 2^{}, to fit the range of {}\n", r.machine.length_exponent, r.machine.format);
}

std::string memory_line(const RenderReport& r) {
    return fmt::format("memory  {} in {}{}{}\n", required_size_text(r.machine.pe_memory_used_bytes),
                       r.of_machine.title.empty() ? "each PE" : "the fullest node",
                       r.machine.pe_memory_bytes ? fmt::format(" of {}", available_size_text(r.machine.pe_memory_bytes))
                                                 : ", no limit",
                       r.of_machine.memory);
}

// Returns a line with the number and size of the messages of all ranks, and the longest waiting time of a rank.
std::string ranks_line(const RenderReport& r) {
    if (r.ranks.empty()) return {};
    double max_waiting_s = 0;
    std::uint64_t messages = 0, bytes = 0;
    std::set<std::string> hosts;
    for (const Json& rank : r.ranks) {
        max_waiting_s = std::max(max_waiting_s, json_number(rank.at("waiting_s")));
        messages += json_integer(rank.at("messages_sent"));
        bytes += json_integer(rank.at("bytes_sent"));
        hosts.insert(json_text(rank.at("host")));
    }
    return fmt::format("ranks   {} on {}; {}, {} sent; longest wait for other ranks {:.3f} s\n", r.ranks.size(),
                       counted(hosts.size(), "host"), counted(messages, "message"), required_size_text(bytes),
                       max_waiting_s);
}

}  // namespace

std::string load_line(const std::string& label, const Load& load, const std::string& remark) {
    return fmt::format("{:7} u = {:.3f}, speed-up {:.1f} of {}, efficiency {:.1f} % (modelled cycles{})\n", label,
                       load.imbalance, load.speedup, load.per_pe.size(), 100 * load.efficiency, remark);
}

std::string summary_text(const RenderReport& r) {
    const EventCounts& e = r.events;
    const std::uint64_t rays = ray_count(e);
    std::string text =
        fmt::format("{}: {} x {} pixels on {} ({}), {}, {}\n", r.scene, r.image.width, r.image.height, r.machine.name,
                    machine_text(r), r.machine.format, counted(r.machine.bounces, "bounce"));
    text += fmt::format("rays    {} = {} primary + {} reflected + {} refracted + {} shadow\n", rays, e[RAYA_PRIMARY],
                        e[RAYA_REFLECTED], e[RAYA_REFRACTED], e[RAYA_SHADOW]);
    if (r.counted) text += load_line("load", r.load, r.requests ? ", simulated" : "");
    text += r.of_machine.lines + scale_line(r) + memory_line(r);
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
