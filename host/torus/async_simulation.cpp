// The processors (the communication task, message by message, and the main task, ray by ray), then the links (output
// threads, what they carry and how fast, input threads).
#include "host/torus/async_simulation.hpp"

#include <algorithm>
#include <stdexcept>

namespace raya {
namespace {

constexpr double kBytesPerWord = 4, kNsPerS = 1e9;

}  // namespace

// The communication task goes first; the main task has what is left.
void AsyncSimulation::add_job(std::uint32_t node, const MessageJob& job) {
    nodes_[node].jobs.push_back(job);
    work(node);
}

void AsyncSimulation::stop_main(Node& n) {
    if (n.task == kNone || !n.computes) return;
    n.left -= now_ - n.since;
    n.computes = false;
    ++n.version;
}

void AsyncSimulation::work(std::uint32_t node) {
    Node& n = nodes_[node];
    if (n.in_job) return;
    if (!n.jobs.empty()) {
        stop_main(n);
        n.in_job = true;
        const std::uint32_t words = history_.messages[n.jobs.front().message].words;
        const double ns = machine_.cycle_ns * (machine_.message_cycles + machine_.word_cycles * words);
        result_.nodes[node].messages_ms += ns * kMsPerNs;
        return foresee(ns, What::kMessageDone, node, 0);
    }
    if (n.task == kNone || n.computes || n.sent != kNone) return;
    n.computes = true;
    n.since = now_;
    foresee(std::max(0.0, n.left), What::kMainDone, node, ++n.version);
}

void AsyncSimulation::finish_job(std::uint32_t node) {
    Node& n = nodes_[node];
    const MessageJob job = n.jobs.front();
    n.jobs.pop_front();
    n.in_job = false;
    if (job.arrives)
        arrive(job.link, job.message);
    else
        begin_to_carry(job.link);
    work(node);
}

// A ray that waits, or else one that is still to be made.
void AsyncSimulation::next_task(std::uint32_t node) {
    Node& n = nodes_[node];
    if (n.task != kNone || (n.queue.empty() && n.own.empty())) return;
    if (!n.queue.empty()) {
        n.task = caused_[n.queue.front()];
        n.queue.pop_front();
    } else {
        n.task = n.own.front();
        n.own.pop_front();
    }
    n.sent = kNone;
    n.left = machine_.cycle_ns * static_cast<double>(history_.tasks[n.task].cycles);
    result_.nodes[node].compute_ms += n.left * kMsPerNs;
    work(node);
}

void AsyncSimulation::finish_task(std::uint32_t node) {
    Node& n = nodes_[node];
    n.computes = false;
    n.sent = 0;
    ++done_;
    send_made(node);
}

// Goes on with what the main task has made, until it waits for a port or all is sent.
void AsyncSimulation::send_made(std::uint32_t node) {
    Node& n = nodes_[node];
    const std::span<const HistoryMessage> made = history_.sent_by(n.task);
    while (n.sent < made.size()) {
        const std::uint32_t message = history_.tasks[n.task].first + n.sent;
        const std::uint32_t link = way_on(node, message);
        if (link == kNone) {
            ++n.sent;
            deliver(message);
            continue;
        }
        const std::uint32_t needs = class_of(message) == 1 ? machine_.entering : 1;
        if (!put(link, {kNone, message, needs})) {
            n.port_since = now_;
            return;
        }
        ++n.sent;
    }
    n.task = kNone;
    next_task(node);
}

void AsyncSimulation::deliver(std::uint32_t message) {
    if (arrived_[message]) throw std::logic_error("async: a message arrives twice");
    arrived_[message] = true;
    ++result_.delivered;
    if (caused_[message] == HistoryTask::kInjection) return;
    const std::uint32_t node = history_.messages[message].to;
    auto& queue = nodes_[node].queue;
    queue.push_back(message);
    result_.nodes[node].queue_max = std::max<std::uint64_t>(result_.nodes[node].queue_max, queue.size());
    next_task(node);
}

// The way by which a message leaves the node; kNone where it has arrived.
std::uint32_t AsyncSimulation::way_on(std::uint32_t node, std::uint32_t message) const {
    const std::uint32_t to = history_.messages[message].to;
    if (node == to) return kNone;
    const std::uint32_t link = class_of(message) == 0 ? raya_home_link(torus_, node) : raya_next_link(torus_, node, to);
    return node * RAYA_LINKS + link;
}

// Into the output thread, or among those that wait for room there.
bool AsyncSimulation::put(std::uint32_t link, const Waiting& from) {
    const std::uint32_t cls = class_of(from.message);
    Way& way = ways_[link];
    if (way.out[cls].size() + from.needs > machine_.buffer) {
        way.waiting[cls].push_back(from);
        return false;
    }
    way.out[cls].push_back(from.message);
    start(link);
    return true;
}

// Room has come free in an output thread: the first that it is enough for takes it. Where a ray that would enter the
// ring waits before one that goes on in it, the latter goes on.
void AsyncSimulation::let_in(std::uint32_t link, std::uint32_t cls) {
    Way& way = ways_[link];
    for (;;) {
        auto& waiting = way.waiting[cls];
        const auto fits = [&](const Waiting& w) { return way.out[cls].size() + w.needs <= machine_.buffer; };
        const auto first = std::ranges::find_if(waiting, fits);
        if (first == waiting.end()) return;
        const Waiting next = *first;
        waiting.erase(first);
        way.out[cls].push_back(next.message);
        start(link);
        if (next.link != kNone) {
            free_input(next.link, cls);
        } else {
            Node& n = nodes_[way.start];
            result_.nodes[way.start].port_ms += (now_ - n.port_since) * kMsPerNs;
            ++n.sent;
            send_made(way.start);
        }
    }
}

// The output thread sends the first message for which the input thread has room; returns, which are short, go first.
void AsyncSimulation::start(std::uint32_t link) {
    Way& way = ways_[link];
    if (way.sending) return;
    for (std::uint32_t cls = 0; cls < kClasses; ++cls) {
        if (way.out[cls].empty() || way.taken[cls]) continue;
        way.sending = way.out[cls].front();
        way.sent_class = cls;
        way.taken[cls] = true;
        return add_job(way.start, {link, *way.sending, false});
    }
}

void AsyncSimulation::begin_to_carry(std::uint32_t link) {
    Way& way = ways_[link];
    way.carries = true;
    way.words_left = history_.messages[*way.sending].words;
    way.rate = 0;
    way.began = now_;
    set_rate(link);
    if (ways_[way.back].carries) set_rate(way.back);
}

// What is carried goes on at the rate that the wire leaves to each way from now on.
void AsyncSimulation::set_rate(std::uint32_t link) {
    Way& way = ways_[link];
    way.words_left -= way.rate * (now_ - way.since);
    way.since = now_;
    double ns = 0;
    if (machine_.one_way > 0) {
        way.rate = (ways_[way.back].carries ? machine_.both_ways / 2 : machine_.one_way) / (kBytesPerWord * kNsPerS);
        ns = way.words_left / way.rate;
    }
    foresee(std::max(0.0, ns), What::kCarried, link, ++way.version);
}

void AsyncSimulation::end_carrying(std::uint32_t link) {
    Way& way = ways_[link];
    const std::uint32_t message = *way.sending, cls = way.sent_class;
    AsyncLink& use = result_.links[link];
    use.busy_ms += (now_ - way.began) * kMsPerNs;
    ++use.messages;
    use.words += history_.messages[message].words;
    way.carries = false;
    way.sending.reset();
    way.out[cls].pop_front();
    if (ways_[way.back].carries) set_rate(way.back);
    add_job(way.end, {link, message, true});
    let_in(link, cls);
    start(link);
}

// The processor has taken a message in: it is the node's own, or goes on.
void AsyncSimulation::arrive(std::uint32_t link, std::uint32_t message) {
    const std::uint32_t node = ways_[link].end, on = way_on(node, message);
    if (on == kNone) {
        deliver(message);
        return free_input(link, class_of(message));
    }
    const bool same_ring = on % RAYA_LINKS == link % RAYA_LINKS;
    const std::uint32_t needs = class_of(message) == 0 || same_ring ? 1 : machine_.entering;
    if (put(on, {link, message, needs})) free_input(link, class_of(message));
}

void AsyncSimulation::free_input(std::uint32_t link, std::uint32_t cls) {
    ways_[link].taken[cls] = false;
    start(link);
}

}  // namespace raya
