#include "host/torus/history.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "kernels/shared/packet.h"

namespace raya {
namespace {

constexpr unsigned kLightBits = 16;
constexpr std::uint64_t kLights = std::uint64_t{1} << kLightBits;

// Hash function: the finaliser of SplitMix64 (Steele, Lea & Flood 2014). It distributes neighbouring pixels over the
// table.
std::uint64_t hash_of(std::uint64_t x) {
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

void require(bool condition, std::size_t index, const char* fault) {
    if (!condition) throw std::logic_error(fmt::format("history: {} {}", fault, index));
}

constexpr std::uint32_t kUnset = UINT32_MAX;

std::uint32_t checked_index(std::size_t count) {
    if (count >= kUnset) throw std::logic_error("history: more than 2^32 - 2 tasks or messages");
    return static_cast<std::uint32_t>(count);
}

RayId id_of(std::uint32_t pixel, std::uint32_t path, std::uint32_t state) {
    return {pixel, RayId::tree_index_of(path, raya_state_level(state)), raya_state_light(state)};
}

}  // namespace

std::uint32_t RayId::tree_index_of(std::uint32_t path, std::uint32_t level) {
    return level == 0 ? 1 : std::uint32_t{1} << level | path >> (32 - level);
}

RayId RayId::parent() const { return light != 0 ? RayId{pixel, tree_index, 0} : RayId{pixel, tree_index / 2, 0}; }

std::uint64_t RayNumbers::number_of(const RayId& id) {
    if (id.tree_index == 0 || id.light >= kLights) throw std::logic_error("RayNumbers: invalid ray id");
    if (3 * (used_slots_ + 1) > 2 * slots_.size()) grow();
    Slot& slot = slot_of(std::uint64_t{id.pixel} << 32 | id.tree_index, id.light);
    if (slot.key == 0) {
        slot = {std::uint64_t{id.pixel} << 32 | id.tree_index, next_number_++ << kLightBits | id.light};
        ++used_slots_;
    }
    return slot.number_and_light >> kLightBits;
}

// Returns the slot of the ray, or the empty slot at which the caller must insert it.
RayNumbers::Slot& RayNumbers::slot_of(std::uint64_t key, std::uint64_t light) {
    std::size_t index = hash_of(key + hash_of(light));
    for (;; ++index) {
        Slot& slot = slots_[index & (slots_.size() - 1)];
        if (slot.key == 0 || (slot.key == key && slot.number_and_light % kLights == light)) return slot;
    }
}

void RayNumbers::grow() {
    std::vector<Slot> old_slots(2 * slots_.size());
    old_slots.swap(slots_);
    for (const Slot& slot : old_slots)
        if (slot.key != 0) slot_of(slot.key, slot.number_and_light % kLights) = slot;
}

std::span<const HistoryMessage> History::sent_by(std::size_t task) const {
    const std::size_t end = task + 1 < tasks.size() ? tasks[task + 1].first_message : messages.size();
    return std::span(messages).subspan(tasks[task].first_message, end - tasks[task].first_message);
}

std::vector<std::uint32_t> tasks_of_messages(const History& history) {
    std::vector<std::uint32_t> task_of_message(history.messages.size(), HistoryTask::kNoCause);
    for (std::size_t t = 0; t < history.tasks.size(); ++t) {
        const std::uint32_t cause = history.tasks[t].cause;
        if (cause == HistoryTask::kNoCause) continue;
        require(cause < task_of_message.size() && task_of_message[cause] == HistoryTask::kNoCause, t,
                "invalid or repeated cause of task");
        task_of_message[cause] = static_cast<std::uint32_t>(t);
    }
    return task_of_message;
}

void check_history(const History& history, std::uint32_t nodes) {
    const auto& [tasks, messages] = history;
    require(tasks.empty() ? messages.empty() : tasks.front().first_message == 0, 0, "messages precede task");
    for (std::size_t t = 0; t < tasks.size(); ++t) {
        const std::size_t end = t + 1 < tasks.size() ? tasks[t + 1].first_message : messages.size();
        require(tasks[t].node < nodes, t, "invalid node of task");
        require(tasks[t].first_message <= end && end <= messages.size(), t, "messages out of order in task");
        for (std::size_t m = tasks[t].first_message; m < end; ++m)
            require(messages[m].task == t, m, "wrong task of message");
        require(tasks[t].cause == HistoryTask::kNoCause || tasks[t].cause < tasks[t].first_message, t,
                "the cause does not precede task");
    }
    const std::vector<std::uint32_t> task_of_message = tasks_of_messages(history);
    for (std::size_t m = 0; m < messages.size(); ++m) {
        const bool is_return = messages[m].kind == RAYA_KIND_RETURN,
                   causes_task = task_of_message[m] != HistoryTask::kNoCause;
        require(messages[m].destination < nodes && messages[m].words > 0, m,
                "invalid destination or no words of message");
        require(causes_task != is_return, m, is_return ? "a task is caused by return" : "no task is caused by ray");
        const std::uint32_t expected_node = is_return ? RAYA_ROOT : tasks[task_of_message[m]].node;
        require(messages[m].destination == expected_node, m, "wrong destination of message");
    }
}

HistoryRecorder::RayProgress& HistoryRecorder::ray_of(std::uint64_t number) {
    if (number >= rays_.size()) rays_.resize(number + 1);
    return rays_[number];
}

std::uint32_t HistoryRecorder::destination_of(std::uint32_t sender, const raya_head& packet) const {
    if (raya_state_kind(packet.state) == RAYA_KIND_RETURN) return RAYA_ROOT;
    if (packet.voxel == RAYA_NO_VOXEL) return sender;
    const raya_place v = raya_unpack_place(packet.voxel);
    const auto& n = torus_.nodes;
    return raya_node_of(torus_, v.at[0] % n[0], v.at[1] % n[1], v.at[2] % n[2]);
}

std::uint16_t HistoryRecorder::words_of(std::uint32_t kind) const {
    return static_cast<std::uint16_t>(kind == RAYA_KIND_RETURN ? packets_.return_words() : packets_.ray_words);
}

void HistoryRecorder::append(const SentMessage& sent) {
    if (sent.message.kind != RAYA_KIND_RETURN) ray_of(sent.ray).message = checked_index(history_.messages.size());
    history_.messages.push_back(sent.message);
}

void HistoryRecorder::add(const NodeWork& work) {
    add_injection_tasks(work);
    const std::size_t first_task = history_.tasks.size();
    add_processing_tasks(work);
    add_messages(work, first_task);
}

// Adds a task for each primary ray that the node has created in this superstep. If the node has also processed the ray,
// it is in work.processed; otherwise it is still in the queue slot in which the node created it.
void HistoryRecorder::add_injection_tasks(const NodeWork& work) {
    std::vector<SentMessage> sent_messages;
    for (std::size_t slot = 0; slot < work.processed.size(); ++slot) {
        const raya_processed& t = work.processed[slot];
        const raya_head& queued = work.queue[slot].head;
        const bool processed = t.state != RAYA_KIND_NONE;
        const std::uint32_t state = processed ? t.state : queued.state;
        if (raya_state_kind(state) != RAYA_KIND_PRIMARY) continue;
        const std::uint64_t ray = numbers_.number_of(id_of(processed ? t.pixel : queued.pixel, 0, state));
        if (ray_of(ray).message != kUnset) continue;
        const std::uint32_t destination = processed ? work.node : destination_of(work.node, queued);
        sent_messages.push_back(
            {{.destination = destination, .words = words_of(RAYA_KIND_PRIMARY), .kind = RAYA_KIND_PRIMARY}, ray});
    }
    std::uint64_t cycles = unassigned_cycles_[work.node] + work.injection_cycles, remaining_rays = sent_messages.size();
    for (SentMessage& ray : sent_messages) {
        const std::uint64_t ray_cycles = cycles / remaining_rays--;
        cycles -= ray_cycles;
        ray.message.task = checked_index(history_.tasks.size());
        history_.tasks.push_back(
            {.node = work.node, .cycles = ray_cycles, .first_message = checked_index(history_.messages.size())});
        append(ray);
    }
    unassigned_cycles_[work.node] = cycles;
}

void HistoryRecorder::add_processing_tasks(const NodeWork& work) {
    const std::uint32_t first_message = checked_index(history_.messages.size());
    for (const raya_processed& t : work.processed) {
        if (t.state == RAYA_KIND_NONE) continue;
        RayProgress& ray = ray_of(numbers_.number_of(id_of(t.pixel, t.path, t.state)));
        if (ray.message == kUnset) throw std::logic_error("history: a packet that no task sent");
        ray.task = checked_index(history_.tasks.size());
        history_.tasks.push_back(
            {.node = work.node, .cause = ray.message, .cycles = t.cycles, .first_message = first_message});
    }
}

// Adds the packets that the tasks from `first_task` on created or changed. These packets have RAYA_STATE_FRESH. A
// packet of an earlier superstep that waits for a link also has this flag. It is skipped, because its ray's last task
// precedes `first_task`.
void HistoryRecorder::add_messages(const NodeWork& work, std::size_t first_task) {
    std::vector<SentMessage> sent_messages;
    for (const raya_packet& p : work.queue) {
        const raya_head& h = p.head;
        const std::uint32_t kind = raya_state_kind(h.state);
        if (kind == RAYA_KIND_NONE || !(h.state & RAYA_STATE_FRESH)) continue;
        if (kind == RAYA_KIND_RETURN && !(h.state & RAYA_STATE_CHARGED)) continue;
        const RayId id = id_of(h.pixel, h.path, h.state);
        const std::uint64_t ray = numbers_.number_of(id);
        const bool is_new = kind != RAYA_KIND_RETURN && kind != RAYA_KIND_PRIMARY && ray_of(ray).message == kUnset;
        const std::uint32_t task = ray_of(is_new ? numbers_.number_of(id.parent()) : ray).task;
        if (task == kUnset || task < first_task) continue;
        sent_messages.push_back(
            {{task, destination_of(work.node, h), words_of(kind), static_cast<std::uint16_t>(kind)}, ray});
    }
    std::ranges::stable_sort(sent_messages, {}, [](const SentMessage& sent) { return sent.message.task; });
    std::size_t next_message = 0;
    for (std::size_t task = first_task; task < history_.tasks.size(); ++task) {
        history_.tasks[task].first_message = checked_index(history_.messages.size());
        for (; next_message < sent_messages.size() && sent_messages[next_message].message.task == task; ++next_message)
            append(sent_messages[next_message]);
    }
}

History HistoryRecorder::finish() {
    for (std::uint32_t node = 0; node < unassigned_cycles_.size(); ++node)
        if (unassigned_cycles_[node] > 0)
            history_.tasks.push_back({.node = node,
                                      .cycles = unassigned_cycles_[node],
                                      .first_message = checked_index(history_.messages.size())});
    check_history(history_, raya_nodes(torus_));
    return std::move(history_);
}

}  // namespace raya
