#include "host/torus/history.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "kernels/shared/packet.h"

namespace raya {
namespace {

constexpr std::uint32_t kUnset = UINT32_MAX;

std::uint32_t checked_index(std::size_t count) {
    if (count >= kUnset) throw std::logic_error("history: more than 2^32 - 2 tasks or messages");
    return static_cast<std::uint32_t>(count);
}

}  // namespace

RayId RayId::of(std::uint32_t pixel, std::uint32_t path, std::uint32_t state) {
    const std::uint32_t level = raya_state_level(state);
    return {pixel, level == 0 ? 1 : std::uint32_t{1} << level | path >> (32 - level), raya_state_light(state)};
}

RayId RayId::parent() const { return {pixel, light != 0 ? tree_index : tree_index / 2, 0}; }

std::span<const HistoryMessage> History::sent_by(std::size_t task) const {
    const std::size_t end = task + 1 < tasks.size() ? tasks[task + 1].first_message : messages.size();
    return std::span(messages).subspan(tasks[task].first_message, end - tasks[task].first_message);
}

std::vector<std::uint32_t> tasks_of_messages(const History& history) {
    std::vector<std::uint32_t> task_of_message(history.messages.size(), HistoryTask::kNoCause);
    for (std::size_t t = 0; t < history.tasks.size(); ++t) {
        const std::uint32_t cause = history.tasks[t].cause;
        if (cause == HistoryTask::kNoCause) continue;
        if (task_of_message.at(cause) != HistoryTask::kNoCause)
            throw std::logic_error(fmt::format("history: message {} causes two tasks", cause));
        task_of_message[cause] = static_cast<std::uint32_t>(t);
    }
    return task_of_message;
}

std::uint16_t HistoryRecorder::words_of(std::uint32_t kind) const {
    return static_cast<std::uint16_t>(kind == RAYA_KIND_RETURN ? packets_.return_words() : packets_.ray_words);
}

void HistoryRecorder::append(const SentMessage& sent) {
    if (sent.message.kind != RAYA_KIND_RETURN) rays_[sent.ray].message = checked_index(history_.messages.size());
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
        const RayId ray{processed ? t.pixel : queued.pixel};
        if (rays_[ray].message != kUnset) continue;
        const std::uint32_t destination = processed ? work.node : destination_of(torus_, work.node, queued);
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
        RayProgress& ray = rays_[RayId::of(t.pixel, t.path, t.state)];
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
        const RayId ray = RayId::of(h.pixel, h.path, h.state);
        const bool is_new = kind != RAYA_KIND_RETURN && kind != RAYA_KIND_PRIMARY && rays_[ray].message == kUnset;
        const std::uint32_t task = rays_[is_new ? ray.parent() : ray].task;
        if (task == kUnset || task < first_task) continue;
        sent_messages.push_back(
            {{task, destination_of(torus_, work.node, h), words_of(kind), static_cast<std::uint16_t>(kind)}, ray});
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
    return std::move(history_);
}

}  // namespace raya
