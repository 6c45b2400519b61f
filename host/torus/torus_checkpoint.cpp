#include "host/torus/torus_checkpoint.hpp"

#include <fmt/core.h>

#include <array>
#include <optional>
#include <utility>

#include "host/base/encoding.hpp"
#include "host/error.hpp"
#include "host/torus/topology.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// Collective: returns, in rank 0, a hash of the words of all nodes. It does not depend on the number of ranks.
std::string memories_hash(const NodeMemories& memories, const NodeDistribution& distribution, Ranks& ranks) {
    constexpr std::size_t kHashDigits = 32;
    std::string digits;
    for (std::uint32_t slot = 0; slot < distribution.nodes(); ++slot) {
        const std::size_t words = memories.starts[slot + 1] - memories.starts[slot];
        digits += words_hash(std::span(memories.words).subspan(memories.starts[slot], words));
    }
    const std::vector<char> all = ranks.gather(std::span<const char>(digits), distribution.sizes_of_ranks(kHashDigits));
    if (all.empty()) return "";
    const std::vector<char> by_node = distribution.in_order_of_nodes(all, kHashDigits);
    return bytes_hash({by_node.data(), by_node.size()});
}

StateSettings state_settings(const TorusSettings& s, const NodeBuffers& buffers, const std::string& hash) {
    return {{"raya", raya_version()},
            {"a machine of type", "torus"},
            {"--size", fmt::format("{}x{}", s.width, s.height)},
            {"--nodes", sides_text({s.torus.nodes[0], s.torus.nodes[1], s.torus.nodes[2]})},
            {"--links", links_name(s.links)},
            {"--voxels", sides_text(s.voxels)},
            {"--inject", s.inject == Injection::kRoot ? "root" : "all"},
            {"--returns", s.packets.one_return_per_ray ? "rays" : "terms"},
            {"--packet-words", std::to_string(s.packets.ray_words)},
            {"--queue", std::to_string(buffers.queue)},
            {"--format", format_name(s.format)},
            {"--bounces", std::to_string(s.bounces)},
            {"--sampling", s.sampling == Sampling::kCorners ? "corners" : "centres"},
            {"every Nth pixel, from", fmt::format("{}, {}", s.pixels.stride, s.pixels.first)},
            {"another scene, camera or light", hash}};
}

}  // namespace

TorusCheckpoints::TorusCheckpoints(const Checkpointing* checkpointing, const TorusSettings& settings,
                                   const TorusJob& job, const NodeDistribution& distribution, Ranks& ranks)
    : checkpointing_(checkpointing), ranks_(ranks), buffers_(job.buffers), nodes_(raya_nodes(settings.torus)) {
    if (checkpointing_ != nullptr)
        settings_ = state_settings(settings, buffers_, memories_hash(job.memories, distribution, ranks));
}

bool TorusCheckpoints::resume(NodeArray& nodes, TorusRun& run) {
    if (checkpointing_ == nullptr || !checkpointing_->resume) return false;
    std::optional<TorusState> resumed;
    if (ranks_.is_first())
        checkpointing_->resume([&](std::string_view bytes) {
            resumed = read_state(bytes, settings_, nodes_, buffers_);
            return resumed->part;
        });
    char resumes = resumed.has_value();
    ranks_.broadcast(resumes);
    if (!resumes) return false;
    if (!ranks_.is_first()) resumed.emplace();
    earlier_s_ = resumed->part.seconds;
    run = std::move(resumed->run);
    for (std::uint32_t* number : {&run.superstep, &run.stalled}) ranks_.broadcast(*number);
    ranks_.broadcast(run.reserve);
    ranks_.broadcast(run.max_live);
    run.link_words.resize(std::size_t{nodes_} * RAYA_LINKS);
    nodes.restore(std::move(resumed->nodes));
    return true;
}

void TorusCheckpoints::save_if_due(NodeArray& nodes, const NodeStatus& status, TorusRun& run, double fraction) {
    if (checkpointing_ == nullptr) return;
    char is_due = ranks_.is_first() && checkpointing_->due();
    ranks_.broadcast(is_due);
    if (!is_due) return;
    nodes.finish_gather(run.returns);
    const NodesState state = nodes.save(status);
    if (ranks_.is_first())
        checkpointing_->save(state_bytes(run, state, {fraction, earlier_s_ + seconds_since(start_)}, settings_));
}

}  // namespace raya
