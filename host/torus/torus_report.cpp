#include "host/torus/torus_report.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "host/model/budget.hpp"
#include "host/model/number_format.hpp"
#include "host/torus/topology.hpp"

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

const char* returns_name(const PacketCharge& packets) { return packets.one_return_per_ray ? "rays" : "terms"; }

struct LinkBytes {
    std::uint64_t links = 0;  // number of unidirectional links between different nodes
    std::uint64_t max = 0, total = 0;
    std::array<std::uint64_t, RAYA_LINKS> by_direction{};  // over +x, -x, +y, -y, +z, -z links
    std::vector<std::uint64_t> sent;                       // [node]: number of bytes that the node sent

    LinkBytes(const raya_torus& torus, const std::vector<std::uint64_t>& words)
        : links(std::uint64_t{raya_nodes(torus)} * links_of_node(torus)), sent(words.size() / RAYA_LINKS) {
        for (std::size_t i = 0; i < words.size(); ++i) {
            const std::uint64_t bytes = 4 * words[i];
            max = std::max(max, bytes);
            total += bytes;
            by_direction[i % RAYA_LINKS] += bytes;
            sent[i / RAYA_LINKS] += bytes;
        }
    }
    double mean() const { return links > 0 ? static_cast<double>(total) / static_cast<double>(links) : 0; }
};

Json torus_json(const TorusSettings& settings, const TorusResult& result, const LinkBytes& bytes) {
    Json packets = Json::object();
    for (const Kind& kind : kKinds)
        packets[kind.name] = {{"made", result.made[kind.number]}, {"ended", result.ended[kind.number]}};
    std::uint64_t live_max = 0;
    for (const Superstep& step : result.supersteps) live_max = std::max(live_max, step.live);
    return {{"nodes", settings.torus.nodes},
            {"voxels", settings.voxels},
            {"links", links_name(settings.links)},
            {"inject", settings.inject == Injection::kRoot ? "root" : "all"},
            {"discarded", result.events[RAYA_DISCARDED]},
            {"returns", {{"of", returns_name(settings.packets)}, {"messages", result.returns}}},
            {"message_words", {{"ray", settings.packets.ray_words}, {"return", settings.packets.return_words()}}},
            {"supersteps", result.supersteps.size()},
            {"packets", packets},
            {"live_max", live_max},
            {"hops", result.hops},
            {"bytes_per_link",
             {{"links", bytes.links},
              {"max", bytes.max},
              {"mean", bytes.mean()},
              {"total", bytes.total},
              {"by_direction", bytes.by_direction},
              {"sent_by_node", bytes.sent}}},
            {"queue", result.buffers.queue},
            {"queue_max", result.queue_max},
            {"box", result.buffers.box},
            {"copies", result.copies}};
}

Json time_json(const TorusTime& time) {
    Json json = {{"compute", time.compute_ms}, {"messages", time.messages_ms},     {"processor", time.processor_ms},
                 {"links", time.links_ms},     {"overlapped", time.overlapped_ms}, {"stepwise", time.stepwise_ms}};
    if (const auto& async = time.asynchronous)
        json["asynchronous"] = {{"finish", async->finish_ms},    {"processor", async->processor_ms},
                                {"links", async->links_ms},      {"port", async->port_ms},
                                {"delivered", async->delivered}, {"queue_max", async->queue_max}};
    return json;
}

std::string lines(const TorusSettings& settings, const TorusResult& result, const LinkBytes& bytes,
                  const TorusTime& time) {
    const auto made = std::accumulate(result.made.begin(), result.made.end(), std::uint64_t{0});
    std::string kinds;
    for (const Kind& kind : kKinds)
        kinds += fmt::format("{}{} {}", kinds.empty() ? "" : " + ", result.made[kind.number], kind.name);
    std::string text =
        fmt::format("packets {} = {}; {}\n", made, kinds, counted(result.supersteps.size(), "superstep"));
    text += fmt::format("charged {} of {}, {} words a ray and {} a return; {} primary rays discarded\n",
                        counted(result.returns, "return"), returns_name(settings.packets), settings.packets.ray_words,
                        settings.packets.return_words(), result.events[RAYA_DISCARDED]);
    text += fmt::format("links   {} over {}, {} in all; mean {}, maximum {} over one link\n",
                        counted(result.hops, "message"), counted(bytes.links, "link"),
                        data_text(static_cast<double>(bytes.total)), data_text(bytes.mean()),
                        data_text(static_cast<double>(bytes.max)));
    text += fmt::format(
        "model   {} if nothing waits (processors {}: compute {}, messages {}; links {}), {} step by step (modelled "
        "time of T805s)\n",
        time_text(time.overlapped_ms), time_text(time.processor_ms), time_text(time.compute_ms),
        time_text(time.messages_ms), time_text(time.links_ms), time_text(time.stepwise_ms));
    if (const auto& async = time.asynchronous)
        text += fmt::format(
            "async   {} without supersteps (busiest processor {}, link {}; longest wait of a main task for links {}; "
            "{} messages)\n",
            time_text(async->finish_ms), time_text(async->processor_ms), time_text(async->links_ms),
            time_text(async->port_ms), async->delivered);
    return text;
}

}  // namespace

Json t805_budget_json(const EventCounts& events, const PacketCharge& packets) {
    const Operations operations = operations_of(events);
    std::uint64_t additions = 0, multiplications = 0, words = 0;
    for (std::size_t event = 0; event < events.size(); ++event) {
        const Budget& work = budgets()[event];
        additions += events[event] * work.additions;
        multiplications += events[event] * work.multiplications;
        words += events[event] * packets.words_of(work.creates);
    }
    return {{"additions", additions},         {"multiplications", multiplications}, {"divisions", operations.divisions},
            {"roots", operations.roots},      {"moves", operations.moves},          {"packet_words", words},
            {"branches", operations.branches}};
}

MachineReport torus_report(const TorusSettings& settings, const TorusResult& result,
                           const std::optional<AsynchronousTime>& asynchronous) {
    const LinkBytes bytes(settings.torus, result.link_words);
    TorusTime time = torus_time(settings.torus, result);
    time.asynchronous = asynchronous;
    return {
        .json = {{"torus", torus_json(settings, result, bytes)},
                 {"budget", t805_budget_json(result.events, settings.packets)},
                 {"modelled_ms", time_json(time)}},
        .title = fmt::format("{} nodes, {}, {} voxels", fmt::join(settings.torus.nodes, "x"),
                             links_name(settings.links), fmt::join(settings.voxels, "x")),
        .lines = lines(settings, result, bytes, time),
        .memory = fmt::format("; queues of {}, at most {} used; {} of objects", counted(result.buffers.queue, "packet"),
                              result.queue_max, counted(result.copies, "copy", "copies"))};
}

}  // namespace raya
