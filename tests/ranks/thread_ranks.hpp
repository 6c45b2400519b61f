// Ranks as threads of one process. Messages are copied, and a rank that waits for a message gets a RankFailure when
// another rank fails.
#pragma once
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "host/cl/device.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

/// The messages that the ranks of a test have sent and not yet received.
struct MessageStore {
    using Key = std::tuple<std::uint32_t, std::uint32_t, int>;  // from, to, tag
    std::mutex mutex{};
    std::condition_variable changed{};
    std::map<Key, std::deque<std::vector<std::byte>>> messages{};
    bool failed = false;

    void put(const Key& key, std::span<const std::byte> bytes) {
        const std::lock_guard lock(mutex);
        messages[key].emplace_back(bytes.begin(), bytes.end());
        changed.notify_all();
    }

    void take(const Key& key, std::span<std::byte> bytes) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return failed || !messages[key].empty(); });
        if (messages[key].empty()) throw RankFailure("another rank failed", 1);
        const std::vector<std::byte> message = std::move(messages[key].front());
        messages[key].pop_front();
        if (message.size() != bytes.size())
            throw std::logic_error("a rank expects another number of bytes than were sent");
        std::copy(message.begin(), message.end(), bytes.begin());
    }

    void fail() {
        const std::lock_guard lock(mutex);
        failed = true;
        changed.notify_all();
    }
};

class ThreadTransport final : public Transport {
  public:
    ThreadTransport(MessageStore& store, std::uint32_t rank, std::uint32_t count, std::uint32_t ranks_per_host)
        : store_(store), rank_(rank), count_(count), ranks_per_host_(ranks_per_host) {}

    std::uint32_t rank() const override { return rank_; }
    std::uint32_t count() const override { return count_; }
    std::string host() const override { return "host" + std::to_string(rank_ / ranks_per_host_); }
    std::string library() const override { return "threads"; }

    void broadcast(std::span<std::byte> bytes) override {
        if (rank_ > 0) return store_.take({0, rank_, kBroadcast}, bytes);
        for (std::uint32_t to = 1; to < count_; ++to) store_.put({0, to, kBroadcast}, bytes);
    }

    void all_gather(std::span<const std::byte> own, std::span<std::byte> all,
                    std::span<const std::size_t> sizes) override {
        for (std::uint32_t to = 0; to < count_; ++to) store_.put({rank_, to, kGather}, own);
        for (std::uint32_t from = 0; from < count_; ++from) {
            store_.take({from, rank_, kGather}, all.first(sizes[from]));
            all = all.subspan(sizes[from]);
        }
    }

    void start(std::span<const Outgoing> out, std::span<const Incoming> in) override {
        if (!pending_.empty()) throw std::logic_error("start: the last one has not been waited for");
        for (const Outgoing& m : out) store_.put({rank_, m.to, m.tag}, m.bytes);
        pending_.assign(in.begin(), in.end());
    }
    void wait() override {
        for (const Incoming& m : pending_) store_.take({m.from, rank_, m.tag}, m.bytes);
        pending_.clear();
    }

    void poll_failures() override {}
    void report_failure(const std::string&, int) override {}
    [[noreturn]] void abort(int) override { throw std::logic_error("a rank of threads does not abort"); }
    void close() override {}

  private:
    static constexpr int kBroadcast = -1, kGather = -2;

    MessageStore& store_;
    std::uint32_t rank_, count_, ranks_per_host_;
    std::vector<Incoming> pending_;
};

/// Runs `work` on `count` concurrent ranks, `ranks_per_host` per host. If ranks throw, rethrows the first exception.
/// Throws std::logic_error if a sent message was not received.
inline void on_ranks(std::uint32_t count, const std::function<void(Ranks&)>& work, std::uint32_t ranks_per_host = 8) {
    all_devices();  // concurrent first queries fail: PoCL 3.1 then returns no device to some threads
    MessageStore store;
    std::exception_ptr thrown;
    std::mutex thrown_mutex;
    std::vector<std::thread> threads;
    for (std::uint32_t rank = 0; rank < count; ++rank)
        threads.emplace_back([&, rank] {
            try {
                Ranks ranks(std::make_unique<ThreadTransport>(store, rank, count, ranks_per_host));
                work(ranks);
            } catch (const RankFailure&) {  // another rank throws the exception that caused it
                store.fail();
            } catch (...) {
                const std::lock_guard lock(thrown_mutex);
                if (!thrown) thrown = std::current_exception();
                store.fail();
            }
        });
    for (std::thread& thread : threads) thread.join();
    if (thrown) std::rethrow_exception(thrown);
    for (const auto& [key, messages] : store.messages)
        if (!messages.empty()) throw std::logic_error("a message was sent that no rank received");
}

}  // namespace raya
