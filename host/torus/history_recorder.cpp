#include "host/torus/history_recorder.hpp"

#include <algorithm>
#include <stdexcept>

namespace raya {
namespace {

constexpr std::uint32_t kNone = UINT32_MAX;

std::uint32_t number(std::size_t count) {
    if (count >= kNone) throw std::logic_error("history: more than 2^32 - 2 tasks or messages");
    return static_cast<std::uint32_t>(count);
}

RayName name_of(std::uint32_t pixel, std::uint32_t path, std::uint32_t state) {
    return {pixel, RayName::place_of(path, raya_state_level(state)), raya_state_light(state)};
}

}  // namespace

HistoryRecorder::Ray& HistoryRecorder::ray_of(std::uint64_t number) {
    if (number >= rays_.size()) rays_.resize(number + 1);
    return rays_[number];
}

std::uint32_t HistoryRecorder::goal_of(std::uint32_t node, const raya_head& packet) const {
    if (raya_state_kind(packet.state) == RAYA_KIND_RETURN) return RAYA_ROOT;
    if (packet.voxel == RAYA_NO_VOXEL) return node;
    const raya_place v = raya_unpack_place(packet.voxel);
    const auto& n = torus_.nodes;
    return raya_node_of(torus_, v.at[0] % n[0], v.at[1] % n[1], v.at[2] % n[2]);
}

std::uint16_t HistoryRecorder::words_of(std::uint32_t kind) const {
    return static_cast<std::uint16_t>(kind == RAYA_KIND_RETURN ? packets_.return_words() : packets_.ray_words);
}

void HistoryRecorder::send(const Sent& sent) {
    if (sent.message.kind != RAYA_KIND_RETURN) ray_of(sent.ray).message = number(history_.messages.size());
    history_.messages.push_back(sent.message);
}

void HistoryRecorder::add(const NodeWork& work) {
    add_injection(work);
    const std::size_t first_task = history_.tasks.size();
    add_treated(work);
    add_packets(work, first_task);
}

// Primary rays that have not been seen: treated already, or still in the slots where they were made.
void HistoryRecorder::add_injection(const NodeWork& work) {
    std::vector<Sent> made;
    for (std::size_t slot = 0; slot < work.treated.size(); ++slot) {
        const raya_treated& t = work.treated[slot];
        const raya_head& waits = work.queue[slot].head;
        const bool treated = t.state != RAYA_KIND_NONE;
        const std::uint32_t state = treated ? t.state : waits.state;
        if (raya_state_kind(state) != RAYA_KIND_PRIMARY) continue;
        const std::uint64_t ray = numbers_.number_of(name_of(treated ? t.pixel : waits.pixel, 0, state));
        if (ray_of(ray).message != kNone) continue;
        const std::uint32_t to = treated ? work.node : goal_of(work.node, waits);
        made.push_back({{.to = to, .words = words_of(RAYA_KIND_PRIMARY), .kind = RAYA_KIND_PRIMARY}, ray});
    }
    std::uint64_t cycles = in_vain_[work.node] + work.injection_cycles, left = made.size();
    for (Sent& ray : made) {
        const std::uint64_t share = cycles / left--;
        cycles -= share;
        ray.message.task = number(history_.tasks.size());
        history_.tasks.push_back({.node = work.node, .cycles = share, .first = number(history_.messages.size())});
        send(ray);
    }
    in_vain_[work.node] = cycles;
}

void HistoryRecorder::add_treated(const NodeWork& work) {
    const std::uint32_t first_message = number(history_.messages.size());
    for (const raya_treated& t : work.treated) {
        if (t.state == RAYA_KIND_NONE) continue;
        Ray& ray = ray_of(numbers_.number_of(name_of(t.pixel, t.path, t.state)));
        if (ray.message == kNone) throw std::logic_error("history: a packet that nobody sent");
        ray.task = number(history_.tasks.size());
        history_.tasks.push_back({.node = work.node, .cause = ray.message, .cycles = t.cycles, .first = first_message});
    }
}

// What is fresh was made or changed by a packet treated here and now; or it is older and waits for a link, and then the
// ray that it came from was treated before.
void HistoryRecorder::add_packets(const NodeWork& work, std::size_t first_task) {
    std::vector<Sent> made;
    for (const raya_packet& p : work.queue) {
        const raya_head& h = p.head;
        const std::uint32_t kind = raya_state_kind(h.state);
        if (kind == RAYA_KIND_NONE || !(h.state & RAYA_STATE_FRESH)) continue;
        if (kind == RAYA_KIND_RETURN && !(h.state & RAYA_STATE_CHARGED)) continue;
        const RayName name = name_of(h.pixel, h.path, h.state);
        const std::uint64_t ray = numbers_.number_of(name);
        const bool is_new = kind != RAYA_KIND_RETURN && kind != RAYA_KIND_PRIMARY && ray_of(ray).message == kNone;
        const std::uint32_t task = ray_of(is_new ? numbers_.number_of(name.parent()) : ray).task;
        if (task == kNone || task < first_task) continue;
        made.push_back({{task, goal_of(work.node, h), words_of(kind), static_cast<std::uint16_t>(kind)}, ray});
    }
    std::ranges::stable_sort(made, {}, [](const Sent& sent) { return sent.message.task; });
    std::size_t next = 0;
    for (std::size_t task = first_task; task < history_.tasks.size(); ++task) {
        history_.tasks[task].first = number(history_.messages.size());
        for (; next < made.size() && made[next].message.task == task; ++next) send(made[next]);
    }
}

History HistoryRecorder::finish() {
    for (std::uint32_t node = 0; node < in_vain_.size(); ++node)
        if (in_vain_[node] > 0)
            history_.tasks.push_back(
                {.node = node, .cycles = in_vain_[node], .first = number(history_.messages.size())});
    check_history(history_, raya_nodes(torus_));
    return std::move(history_);
}

}  // namespace raya
