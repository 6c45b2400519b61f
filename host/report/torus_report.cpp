#include "host/report/torus_report.hpp"

#include <fmt/core.h>

#include <numeric>

#include "host/base/json.hpp"
#include "host/model/budget.hpp"
#include "host/model/unit_text.hpp"

namespace raya {
namespace {

struct Kind {
    std::uint32_t number;
    const char* name;
};
constexpr std::array<Kind, RAYA_KINDS - 1> kKinds = {{{RAYA_KIND_PRIMARY, "primary"},
                                                      {RAYA_KIND_REFLECTED, "reflected"},
                                                      {RAYA_KIND_REFRACTED, "refracted"},
                                                      {RAYA_KIND_SHADOW, "shadow"},
                                                      {RAYA_KIND_RETURN, "return"}}};

std::string dimensions_text(const std::array<std::uint32_t, 3>& s) { return fmt::format("{}x{}x{}", s[0], s[1], s[2]); }

}  // namespace

const char* returns_name(const PacketCharge& packets) { return packets.one_return_per_ray ? "rays" : "terms"; }

Json torus_json(const TorusReport& t) {
    Json packets;
    for (const Kind& kind : kKinds)
        packets[kind.name] = {{"made", t.made[kind.number]}, {"ended", t.ended[kind.number]}};
    return {{"nodes", t.nodes},
            {"voxels", t.voxels},
            {"links", t.links},
            {"inject", t.inject},
            {"link_exchange", t.link_exchange},
            {"link_exchange_from", t.link_origin},
            {"discarded", t.discarded},
            {"returns", {{"of", returns_name(t.packets)}, {"messages", t.returns}}},
            {"message_words", {{"ray", t.packets.ray_words}, {"return", t.packets.return_words()}}},
            {"supersteps", t.supersteps},
            {"packets", packets},
            {"live_max", t.live_max},
            {"hops", t.hops},
            {"bytes_per_link",
             {{"links", t.link.count},
              {"max", t.link.max_bytes},
              {"mean", t.link.mean_bytes()},
              {"total", t.link.total_bytes},
              {"by_direction", t.link.by_direction},
              {"sent_by_node", t.link.sent}}},
            {"queue", t.queue},
            {"queue_max", t.queue_max},
            {"box", t.box},
            {"copies", t.copies}};
}

Json torus_time_json(const TorusTime& time) {
    Json json = {{"compute", time.compute_ms}, {"messages", time.messages_ms},     {"processor", time.processor_ms},
                 {"links", time.links_ms},     {"overlapped", time.overlapped_ms}, {"stepwise", time.stepwise_ms}};
    if (const auto& async = time.asynchronous)
        json["asynchronous"] = {{"finish", async->finish_ms},    {"processor", async->processor_ms},
                                {"links", async->links_ms},      {"port", async->port_ms},
                                {"delivered", async->delivered}, {"queue_max", async->queue_max}};
    return json;
}

Json t805_budget_json(const EventCounts& events, const PacketCharge& packets) {
    const Operations operations = operations_of(events);
    std::uint64_t additions = 0, multiplications = 0, words = 0;
    for (std::size_t event = 0; event < events.size(); ++event) {
        const T805Work& work = t805_work()[event];
        additions += events[event] * work.additions;
        multiplications += events[event] * work.multiplications;
        words += events[event] * packets.words_of(work.creates);
    }
    return {{"additions", additions},         {"multiplications", multiplications}, {"divisions", operations.divisions},
            {"roots", operations.roots},      {"moves", operations.moves},          {"packet_words", words},
            {"branches", operations.branches}};
}

std::string torus_machine_text(const TorusReport& t) {
    return fmt::format("{} nodes, {}, {} voxels", dimensions_text(t.nodes), t.links, dimensions_text(t.voxels));
}

std::string torus_lines(const TorusReport& t) {
    const auto made = std::accumulate(t.made.begin(), t.made.end(), std::uint64_t{0});
    std::string kinds;
    for (const Kind& kind : kKinds)
        kinds += fmt::format("{}{} {}", kinds.empty() ? "" : " + ", t.made[kind.number], kind.name);
    std::string text = fmt::format("packets {} = {}; {}\n", made, kinds, counted(t.supersteps, "superstep"));
    text += fmt::format("charged {} of {}, {} words a ray and {} a return; {} primary rays discarded\n",
                        counted(t.returns, "return"), returns_name(t.packets), t.packets.ray_words,
                        t.packets.return_words(), t.discarded);
    text +=
        fmt::format("links   {} over {}, {} in all; mean {}, maximum {} over one link\n", counted(t.hops, "message"),
                    counted(t.link.count, "link"), data_text(static_cast<double>(t.link.total_bytes)),
                    data_text(t.link.mean_bytes()), data_text(static_cast<double>(t.link.max_bytes)));
    const TorusTime& m = t.modelled;
    text += fmt::format(
        "model   {} if nothing waits (processors {}: compute {}, messages {}; links {}), {} step by step (modelled "
        "time of T805s)\n",
        time_text(m.overlapped_ms), time_text(m.processor_ms), time_text(m.compute_ms), time_text(m.messages_ms),
        time_text(m.links_ms), time_text(m.stepwise_ms));
    if (const auto& async = m.asynchronous)
        text += fmt::format(
            "async   {} without supersteps (busiest processor {}, link {}; longest wait of a main task for links {}; "
            "{} messages)\n",
            time_text(async->finish_ms), time_text(async->processor_ms), time_text(async->links_ms),
            time_text(async->port_ms), async->delivered);
    return text;
}

std::string torus_memory_text(const TorusReport& t) {
    return fmt::format("; queues of {}, at most {} used; {} of objects", counted(t.queue, "packet"), t.queue_max,
                       counted(t.copies, "copy", "copies"));
}

}  // namespace raya
