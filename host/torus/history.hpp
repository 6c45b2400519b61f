// The history of a render on the torus: what nodes computed, and the messages by which one thing led to another,
// without supersteps. What is computed and sent does not depend on when it is: so a history holds for any order in
// time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/model/t805.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// A ray, by its pixel and its place in the pixel's ray tree.
struct RayName {
    std::uint32_t pixel = 0;  // row W + column
    /// Of the tree's nodes the primary ray is 1, the reflected ray of node n is 2 n, the refracted one 2 n + 1: at
    /// level l a number of l + 1 bits, so that 31 bounces fit.
    std::uint32_t place = 1;
    std::uint32_t light = 0;  // of a shadow ray its light's number + 1, at most 65,535; 0 for the ray that is shaded

    /// The ray's place from the PATH of a packet and its level, 0..31 (kernels/shared/packet.h).
    static std::uint32_t place_of(std::uint32_t path, std::uint32_t level);

    /// The ray that was reflected or refracted into this one, or that this shadow ray shades. Not of a primary ray.
    RayName parent() const;
};

/// An open hash table, as there can be tens of millions: 16 bytes a slot, two thirds of them taken at most, twice as
/// many slots when there are more. So it takes 24 to 48 bytes a ray, half as much again while it grows.
class RayNumbers {
  public:
    /// The ray's number; the next one, counted from 0, for a ray that has none. std::logic_error for what is no name.
    std::uint64_t number_of(const RayName& name);

    /// A number for what will never be asked for again.
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

/// Computing of one node without a pause: one packet's treatment, or the making of one primary ray.
struct HistoryTask {
    static constexpr std::uint32_t kInjection = UINT32_MAX;  // as a cause: the node begins it by itself

    std::uint32_t node = 0;
    std::uint32_t cause = kInjection;  // the message whose arrival starts it
    std::uint64_t cycles = 0;          // modelled
    std::uint32_t first = 0;           // of its messages, which lie one after another
};

/// A packet that a task has made or changed: a ray for the node that treats it next, which may be the task's own, or a
/// return for the root.
struct HistoryMessage {
    std::uint32_t task = 0;  // that sends it, at its end
    std::uint32_t to = 0;    // node
    std::uint16_t words = 0;
    std::uint16_t kind = 0;  // RAYA_KIND_* of kernels/shared/packet.h
};

/// A task comes behind the message that causes it, messages lie in the order of their tasks; the tasks that a node
/// begins by itself are in the order in which it does.
struct History {
    std::vector<HistoryTask> tasks;
    std::vector<HistoryMessage> messages;

    std::span<const HistoryMessage> sent_by(std::size_t task) const;
};

/// std::logic_error unless all that is said above holds, every ray causes one task, at the node where it goes, and
/// every return none, and goes to the root.
void check_history(const History& history, std::uint32_t nodes);

/// Of each message the task that it causes; HistoryTask::kInjection for a return.
std::vector<std::uint32_t> tasks_of_messages(const History& history);

/// Takes the work of all nodes, superstep by superstep, as a NodeWorkSink is given it. Keeps 24 bytes for each ray in
/// each voxel and 12 for each packet, and the numbers of the rays.
class HistoryRecorder {
  public:
    /// `packets`: what messages are charged for. Returns that go with another one for nothing are in no history.
    explicit HistoryRecorder(const raya_torus& torus, const PacketCharge& packets = {})
        : torus_(torus), packets_(packets), in_vain_(raya_nodes(torus)) {}

    /// std::logic_error for a packet that nobody sent, or more of them than numbers of 32 bits.
    void add(const NodeWork& work);

    /// The whole history, checked; the last that may be asked of the recorder. Its tasks' cycles are those of the
    /// render: of a node those of its packets and of its injection. What rays that were made in vain cost is part of
    /// the next one's that the node kept, behind the last one a task of its own.
    History finish();

  private:
    struct Sent {
        HistoryMessage message;
        std::uint64_t ray = 0;  // number of the ray that it is or, of a return, comes from
    };
    struct Ray {
        std::uint32_t message = UINT32_MAX;  // its last one
        std::uint32_t task = UINT32_MAX;     // its last treatment
    };
    Ray& ray_of(std::uint64_t number);
    void add_injection(const NodeWork& work);
    void add_treated(const NodeWork& work);
    void add_packets(const NodeWork& work, std::size_t first_task);
    std::uint32_t goal_of(std::uint32_t node, const raya_head& packet) const;
    std::uint16_t words_of(std::uint32_t kind) const;
    void send(const Sent& sent);

    raya_torus torus_;
    PacketCharge packets_;
    History history_;
    RayNumbers numbers_;
    std::vector<Ray> rays_;               // [number]
    std::vector<std::uint64_t> in_vain_;  // [node]: cycles of injection that no ray has been charged with
};

}  // namespace raya
