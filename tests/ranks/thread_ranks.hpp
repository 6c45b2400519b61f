// Ranks as threads of one process. If a rank fails, ranks that wait for a message throw RankFailure.
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

/// Messages that ranks have sent and that their receivers have not received yet.
struct MessageStore {
    using Key = std::tuple<std::uint32_t, std::uint32_t, int>;  // sender, receiver, tag
    std::mutex mutex{};
    std::condition_variable changed{};
    std::map<Key, std::deque<std::vector<std::byte>>> messages{};
    bool failed = false;  // true: a rank has failed

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
            throw std::logic_error("a receiver expects " + std::to_string(bytes.size()) +
                                   " bytes, but the message has " + std::to_string(message.size()));
        std::copy(message.begin(), message.end(), bytes.begin());
    }

    void fail() {
        const std::lock_guard lock(mutex);
        failed = true;
        changed.notify_all();
    }
};

/// Transport between threads of one process, through a MessageStore.
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
        for (std::uint32_t receiver = 1; receiver < count_; ++receiver) store_.put({0, receiver, kBroadcast}, bytes);
    }

    void all_gather(std::span<const std::byte> own_bytes, std::span<std::byte> all_bytes,
                    std::span<const std::size_t> sizes) override {
        for (std::uint32_t receiver = 0; receiver < count_; ++receiver)
            store_.put({rank_, receiver, kGather}, own_bytes);
        for (std::uint32_t sender = 0; sender < count_; ++sender) {
            store_.take({sender, rank_, kGather}, all_bytes.first(sizes[sender]));
            all_bytes = all_bytes.subspan(sizes[sender]);
        }
    }

    void start(std::span<const OutgoingMessage> out, std::span<const IncomingMessage> in) override {
        if (!pending_.empty()) throw std::logic_error("start: wait() was not called after the previous start()");
        for (const OutgoingMessage& m : out) store_.put({rank_, m.receiver, m.tag}, m.bytes);
        pending_.assign(in.begin(), in.end());
    }
    void wait() override {
        for (const IncomingMessage& m : pending_) store_.take({m.sender, rank_, m.tag}, m.bytes);
        pending_.clear();
    }

    [[noreturn]] void abort(int) override { throw std::logic_error("ThreadTransport does not support abort()"); }

  private:
    static constexpr int kBroadcast = -1, kGather = -2;  // tags

    MessageStore& store_;
    std::uint32_t rank_, count_, ranks_per_host_;
    std::vector<IncomingMessage> pending_;
};

/// One of `count` ranks that cannot communicate, for what depends on the numbers only.
inline Ranks silent_rank(std::uint32_t rank, std::uint32_t count) {
    struct Silent final : Transport {
        Silent(std::uint32_t own, std::uint32_t all) : rank_(own), count_(all) {}
        std::uint32_t rank() const override { return rank_; }
        std::uint32_t count() const override { return count_; }
        void all_gather(std::span<const std::byte>, std::span<std::byte>, std::span<const std::size_t>) override {}
        std::uint32_t rank_, count_;
    };
    return Ranks(std::make_unique<Silent>(rank, count));
}

/// Runs `work` on `count` concurrent ranks, `ranks_per_host` per host. If ranks throw, rethrows the first exception.
/// Throws std::logic_error if a sent message was not received.
inline void on_ranks(std::uint32_t count, const std::function<void(Ranks&)>& work, std::uint32_t ranks_per_host = 8) {
    // This thread queries first: if several threads make the first query, PoCL 3.1 returns no device to some of them.
    all_devices();
    MessageStore store;
    std::exception_ptr first_exception;
    std::mutex exception_mutex;
    std::vector<std::thread> threads;
    for (std::uint32_t rank = 0; rank < count; ++rank)
        threads.emplace_back([&, rank] {
            try {
                Ranks ranks(std::make_unique<ThreadTransport>(store, rank, count, ranks_per_host));
                work(ranks);
            } catch (const RankFailure&) {  // another rank throws the exception that caused this failure
                store.fail();
            } catch (...) {
                const std::lock_guard lock(exception_mutex);
                if (!first_exception) first_exception = std::current_exception();
                store.fail();
            }
        });
    for (std::thread& thread : threads) thread.join();
    if (first_exception) std::rethrow_exception(first_exception);
    for (const auto& [key, messages] : store.messages)
        if (!messages.empty()) throw std::logic_error("a message was sent that no rank received");
}

}  // namespace raya
