// History of a render on the torus, without supersteps: the computations of the nodes, the messages that the
// computations send, and the message that starts each computation. A history does not depend on timing, so it can be
// replayed with any schedule.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "host/model/t805.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Identifies a ray by its pixel and its position in the pixel's ray tree.
struct RayId {
    std::uint32_t pixel = 0;  // row W + column, where W is the width of the image
    /// Number of the ray in the tree, as in a binary heap: 1 for the primary ray, 2 n for the reflected and 2 n + 1 for
    /// the refracted ray of ray number n. At level l the number has l + 1 bits, so 31 bounces fit.
    std::uint32_t tree_index = 1;
    std::uint32_t light = 0;  // index of a shadow ray's light + 1, at most 65,535; 0 for other rays

    /// Returns the id of the packet's ray; for a return, that of the ray whose contribution it carries.
    static RayId of(std::uint32_t pixel, std::uint32_t path, std::uint32_t state);

    /// Returns the ray whose hit generated this ray. Undefined for a primary ray.
    RayId parent() const;

    bool operator==(const RayId&) const = default;
};

struct RayIdHash {
    std::size_t operator()(const RayId& id) const {
        return std::hash<std::uint64_t>()((std::uint64_t{id.pixel} << 32 | id.tree_index) +
                                          id.light * std::uint64_t{0x9e3779b97f4a7c15});
    }
};

/// A computation of one node, which either processes one packet or generates one primary ray. A task that processes a
/// packet starts when the packet has arrived.
struct HistoryTask {
    static constexpr std::uint32_t kNoCause = UINT32_MAX;

    std::uint32_t node = 0;
    std::uint32_t cause = kNoCause;   // message whose arrival starts the task; kNoCause: no message
    std::uint64_t cycles = 0;         // modelled cycles of the computation
    std::uint32_t first_message = 0;  // index of the first message that the task sends; its messages are contiguous
};

/// A packet that a task created or changed. The task sends a ray to the node that processes the ray next, which may be
/// the task's own node. It sends a return to the root.
struct HistoryMessage {
    std::uint32_t task = 0;         // task that sends the message at the end of its computation
    std::uint32_t destination = 0;  // node
    std::uint16_t words = 0;        // number of words charged for the message
    std::uint16_t kind = 0;         // RAYA_KIND_* of kernels/shared/packet.h
};

/// Tasks and messages of a render. Messages are in the order of the tasks that send them. The cause of a task precedes
/// the messages that the task sends: tasks[t].cause < tasks[t].first_message. The tasks of a node that have no cause
/// are in the order of execution.
struct History {
    std::vector<HistoryTask> tasks;
    std::vector<HistoryMessage> messages;

    /// Returns the messages that a task sends.
    std::span<const HistoryMessage> sent_by(std::size_t task) const;
};

/// Returns [message]: index of the task that the message causes; HistoryTask::kNoCause for a return. Throws
/// std::logic_error for a message that causes two tasks.
std::vector<std::uint32_t> tasks_of_messages(const History& history);

/// Records a history from the work of all nodes in every superstep (NodeWorkSink). Takes 24 bytes for each voxel that a
/// ray visits, 12 bytes for each packet, and about 60 bytes for each ray.
class HistoryRecorder {
  public:
    /// `packets`: numbers of words charged for messages. The history omits returns that are not charged because they
    /// are part of another return.
    explicit HistoryRecorder(const raya_torus& torus, const PacketCharge& packets = {})
        : torus_(torus), packets_(packets), unassigned_cycles_(raya_nodes(torus)) {}

    /// Adds the work of a node in a superstep. Throws std::logic_error for a packet that no task sent, and for more
    /// than 2^32 - 2 tasks or messages.
    void add(const NodeWork& work);

    /// Returns the history. Must be called once, as the last call. The sum of the cycles of a node's tasks is the
    /// node's cycles in the render. Injection cycles, including those of discarded rays, are divided equally among the
    /// primary rays that the node generates in the superstep. The injection cycles of a superstep without such a ray
    /// are added to those of the next superstep. Cycles that remain at the end become a separate task.
    History finish();

  private:
    struct SentMessage {
        HistoryMessage message;
        RayId ray;  // for a return, the ray whose contribution it carries
    };
    /// Last message and last task of a ray so far; UINT32_MAX: none.
    struct RayProgress {
        std::uint32_t message = UINT32_MAX;  // last message that contained the ray
        std::uint32_t task = UINT32_MAX;     // last task that processed the ray
    };
    void add_injection_tasks(const NodeWork& work);
    void add_processing_tasks(const NodeWork& work);
    void add_messages(const NodeWork& work, std::size_t first_task);
    std::uint16_t words_of(std::uint32_t kind) const;
    void append(const SentMessage& sent);

    raya_torus torus_;
    PacketCharge packets_;
    History history_;
    std::unordered_map<RayId, RayProgress, RayIdHash> rays_;
    std::vector<std::uint64_t> unassigned_cycles_;  // [node]: injection cycles not yet part of a task
};

}  // namespace raya
