// History of a render on the torus: the computations of nodes and the messages that caused them, without supersteps.
// Computations and messages do not depend on their timing, so a history is valid for any schedule.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/model/t805.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Identifies a ray by its pixel and its place in the pixel's ray tree.
struct RayId {
    std::uint32_t pixel = 0;  // row W + column
    /// Heap number in the tree: 1 for the primary ray, 2 n for the reflected and 2 n + 1 for the refracted ray of ray
    /// n. It has l + 1 bits at level l, so that 31 bounces fit.
    std::uint32_t place = 1;
    std::uint32_t light = 0;  // index of a shadow ray's light + 1, at most 65,535; 0 for other rays

    /// The place of the ray with that PATH at that level, 0..31 (kernels/shared/packet.h).
    static std::uint32_t place_of(std::uint32_t path, std::uint32_t level);

    /// The ray that was reflected or refracted into this one, or whose hit this shadow ray belongs to. Undefined for a
    /// primary ray.
    RayId parent() const;
};

/// Numbers rays in the order of first use. An open-addressing hash table, as there may be tens of millions: 16 bytes a
/// slot, load factor at most 2/3, doubled when full, so 24 to 48 bytes a ray, and half as much again while it grows.
class RayNumbers {
  public:
    /// Returns the ray's number, or assigns the next one, from 0 on. Throws std::logic_error for an invalid id.
    std::uint64_t number_of(const RayId& id);

    /// Assigns a number to a packet that needs no later look-up.
    std::uint64_t next() { return next_++; }

  private:
    struct Slot {
        std::uint64_t ray = 0;               // pixel and place; 0: empty, as no place is 0
        std::uint64_t number_and_light = 0;  // 48 bits, 16 bits
    };
    Slot& slot_of(std::uint64_t ray, std::uint64_t light);
    void grow();

    std::vector<Slot> slots_ = std::vector<Slot>(1 << 10);  // a power of 2
    std::size_t taken_ = 0;
    std::uint64_t next_ = 0;
};

/// An uninterrupted computation of one node: it processes one packet or makes one primary ray.
struct HistoryTask {
    static constexpr std::uint32_t kInjection = UINT32_MAX;  // cause of a task that no message starts

    std::uint32_t node = 0;
    std::uint32_t cause = kInjection;  // the message whose arrival starts it
    std::uint64_t cycles = 0;          // modelled
    std::uint32_t first = 0;           // index of its first message; its messages are contiguous
};

/// A packet that a task made or changed: a ray for the node that processes it next, which may be the same node, or a
/// return for the root.
struct HistoryMessage {
    std::uint32_t task = 0;  // sends it at its end
    std::uint32_t to = 0;    // node
    std::uint16_t words = 0;
    std::uint16_t kind = 0;  // RAYA_KIND_* of kernels/shared/packet.h
};

/// Messages are in the order of their tasks, and a task follows its cause: tasks[t].cause < tasks[t].first. Tasks of
/// one node without a cause are in the order of their execution.
struct History {
    std::vector<HistoryTask> tasks;
    std::vector<HistoryMessage> messages;

    std::span<const HistoryMessage> sent_by(std::size_t task) const;
};

/// Throws std::logic_error unless the orders above hold, every ray causes one task, at its destination, and every
/// return goes to the root and causes none.
void check_history(const History& history, std::uint32_t nodes);

/// [message]: the task that it causes; HistoryTask::kInjection for a return.
std::vector<std::uint32_t> tasks_of_messages(const History& history);

/// Records a history from the work of all nodes in every superstep (NodeWorkSink). Needs 24 bytes for each ray in each
/// voxel, 12 for each packet, and the table of ray numbers.
class HistoryRecorder {
  public:
    /// `packets`: words charged for a message. The history omits returns that travel within another one at no charge.
    explicit HistoryRecorder(const raya_torus& torus, const PacketCharge& packets = {})
        : torus_(torus), packets_(packets), uncharged_cycles_(raya_nodes(torus)) {}

    /// Throws std::logic_error for a packet that no task sent, or for more packets than 32-bit numbers.
    void add(const NodeWork& work);

    /// Returns the whole history, checked. To be called once, as the last call. The cycles of a node's tasks add up to
    /// those of the render. The cost of primary rays that a node made and discarded is part of the next ray's task;
    /// what follows the last ray is a task of its own.
    History finish();

  private:
    struct Sent {
        HistoryMessage message;
        std::uint64_t ray = 0;  // number of the ray, or of the ray that the return belongs to
    };
    struct Ray {
        std::uint32_t message = UINT32_MAX;  // that carried it last
        std::uint32_t task = UINT32_MAX;     // that processed it last
    };
    Ray& ray_of(std::uint64_t number);
    void add_injection(const NodeWork& work);
    void add_processed(const NodeWork& work);
    void add_packets(const NodeWork& work, std::size_t first_task);
    std::uint32_t destination_of(std::uint32_t node, const raya_head& packet) const;
    std::uint16_t words_of(std::uint32_t kind) const;
    void send(const Sent& sent);

    raya_torus torus_;
    PacketCharge packets_;
    History history_;
    RayNumbers numbers_;
    std::vector<Ray> rays_;                        // [number]
    std::vector<std::uint64_t> uncharged_cycles_;  // [node]: cycles of injection not charged to a task yet
};

}  // namespace raya
