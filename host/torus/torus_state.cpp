#include "host/torus/torus_state.hpp"

#include <algorithm>

#include "host/error.hpp"

namespace raya {
namespace {

// Calls visit(vector) for all vectors of a state, in their order in the file.
template <class Run, class Nodes, class Visit>
void for_each_vector(Run& run, Nodes& nodes, const Visit& visit) {
    visit(run.supersteps);
    visit(run.link_words);
    visit(run.returns);
    visit(nodes.status);
    for (auto* counters : {&nodes.events, &nodes.made, &nodes.ended}) visit(*counters);
    for (auto* counts : {&nodes.rays, &nodes.returns}) {
        visit(counts->messages);
        visit(counts->packets);
    }
    visit(nodes.packets);
}

// Returns true if no queue and no mailbox has more packets than fit, and `packets` has the words of all packets.
bool is_valid(const NodesState& s, std::uint32_t nodes, const NodeBuffers& buffers) {
    const NodeStatus status(s.status);
    std::size_t words = 0;
    for (std::uint32_t node = 0; node < nodes; ++node) {
        if (std::max(status.at(node, RAYA_STATUS_QUEUE), status.at(node, RAYA_STATUS_HOST)) > buffers.queue)
            return false;
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            for (const std::uint32_t boxes :
                 {RAYA_STATUS_OUTBOX, RAYA_STATUS_INBOX, RAYA_STATUS_RETURN_OUTBOX, RAYA_STATUS_RETURN_INBOX})
                if (status.at(node, boxes + link) > buffers.box) return false;
        words += packet_words(status, node);
    }
    return s.packets.size() == words;
}

// Returns a state whose vectors have the sizes for `nodes` nodes. Vectors without elements may have any size.
TorusState expected_sizes(std::uint32_t nodes) {
    TorusState s;
    s.run.link_words.resize(std::size_t{nodes} * RAYA_LINKS);
    s.nodes.status.resize(std::size_t{nodes} * RAYA_STATUS_WORDS);
    s.nodes.events.resize(std::size_t{nodes} * RAYA_EVENTS);
    s.nodes.made.resize(std::size_t{nodes} * RAYA_KINDS);
    s.nodes.ended = s.nodes.made;
    s.nodes.rays = s.nodes.returns = {s.run.link_words, s.run.link_words};
    return s;
}

}  // namespace

std::size_t packet_words(const NodeStatus& status, std::uint32_t node) {
    std::size_t rays = status.at(node, RAYA_STATUS_QUEUE), returns = 0;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        rays += status.at(node, RAYA_STATUS_OUTBOX + link) + status.at(node, RAYA_STATUS_INBOX + link);
        returns += status.at(node, RAYA_STATUS_RETURN_OUTBOX + link) + status.at(node, RAYA_STATUS_RETURN_INBOX + link);
    }
    return rays * RAYA_PACKET_WORDS + returns * RAYA_RETURN_WORDS;
}

std::string state_bytes(const TorusRun& run, const NodesState& nodes, const RenderedPart& part,
                        const StateSettings& settings) {
    CheckpointWriter writer(settings, part,
                            {{"superstep", run.superstep},
                             {"stalled", run.stalled},
                             {"tight", run.reserve == Reserve::kTight ? 1 : 0},
                             {"live_max", run.max_live}});
    for_each_vector(run, nodes, [&](const auto& values) { writer.put(values); });
    return writer.finish();
}

TorusState read_state(std::string_view bytes, const StateSettings& settings, std::uint32_t nodes,
                      const NodeBuffers& buffers) {
    CheckpointReader reader(bytes, settings);
    TorusState state = expected_sizes(nodes);
    state.part = reader.part();
    state.run.superstep = static_cast<std::uint32_t>(reader.integer("superstep", UINT32_MAX - 1));
    state.run.stalled = static_cast<std::uint32_t>(reader.integer("stalled", 2));
    state.run.reserve = reader.integer("tight", 1) != 0 ? Reserve::kTight : Reserve::kWholeTree;
    state.run.max_live = reader.integer("live_max");
    for_each_vector(state.run, state.nodes, [&]<class T>(std::vector<T>& values) {
        if (values.empty())
            values = reader.take_any<T>();
        else
            reader.take(values);
    });
    if (state.run.supersteps.size() != state.run.superstep || !is_valid(state.nodes, nodes, buffers))
        throw UserError("damaged");
    return state;
}

}  // namespace raya
