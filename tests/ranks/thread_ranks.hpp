// Ranks that are threads of one process: what goes from one to another is copied, waits end when one of them fails.
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

/// Where all ranks of a test leave what they send.
struct Letterbox {
    using Key = std::tuple<std::uint32_t, std::uint32_t, int>;  // from, to, tag
    std::mutex mutex{};
    std::condition_variable changed{};
    std::map<Key, std::deque<std::vector<std::byte>>> letters{};
    bool failed = false;

    void put(const Key& key, std::span<const std::byte> bytes) {
        const std::lock_guard lock(mutex);
        letters[key].emplace_back(bytes.begin(), bytes.end());
        changed.notify_all();
    }

    void take(const Key& key, std::span<std::byte> bytes) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return failed || !letters[key].empty(); });
        if (letters[key].empty()) throw RankFailure("another rank failed", 1);
        const std::vector<std::byte> letter = std::move(letters[key].front());
        letters[key].pop_front();
        if (letter.size() != bytes.size())
            throw std::logic_error("a rank expects another number of bytes than it gets");
        std::copy(letter.begin(), letter.end(), bytes.begin());
    }

    void fail() {
        const std::lock_guard lock(mutex);
        failed = true;
        changed.notify_all();
    }
};

class ThreadTransport final : public Transport {
  public:
    ThreadTransport(Letterbox& box, std::uint32_t rank, std::uint32_t count, std::uint32_t of_host)
        : box_(box), rank_(rank), count_(count), of_host_(of_host) {}

    std::uint32_t rank() const override { return rank_; }
    std::uint32_t count() const override { return count_; }
    std::string host() const override { return "host" + std::to_string(rank_ / of_host_); }
    std::string library() const override { return "threads"; }

    void broadcast(std::span<std::byte> bytes) override {
        if (rank_ > 0) return box_.take({0, rank_, kBroadcast}, bytes);
        for (std::uint32_t to = 1; to < count_; ++to) box_.put({0, to, kBroadcast}, bytes);
    }

    void all_gather(std::span<const std::byte> own, std::span<std::byte> all,
                    std::span<const std::size_t> sizes) override {
        for (std::uint32_t to = 0; to < count_; ++to) box_.put({rank_, to, kGather}, own);
        for (std::uint32_t from = 0; from < count_; ++from) {
            box_.take({from, rank_, kGather}, all.first(sizes[from]));
            all = all.subspan(sizes[from]);
        }
    }

    void start(std::span<const Outgoing> out, std::span<const Incoming> in) override {
        if (!waits_.empty()) throw std::logic_error("start: the last one has not been waited for");
        for (const Outgoing& m : out) box_.put({rank_, m.to, m.tag}, m.bytes);
        waits_.assign(in.begin(), in.end());
    }
    void wait() override {
        for (const Incoming& m : waits_) box_.take({m.from, rank_, m.tag}, m.bytes);
        waits_.clear();
    }

    void look() override {}
    void report_failure(const std::string&, int) override {}
    [[noreturn]] void abort(int) override { throw std::logic_error("a rank of threads does not abort"); }
    void close() override {}

  private:
    static constexpr int kBroadcast = -1, kGather = -2;

    Letterbox& box_;
    std::uint32_t rank_, count_, of_host_;
    std::vector<Incoming> waits_;
};

/// Runs `work` in so many ranks at once, `of_host` on each host, and throws what one of them has thrown. What all have
/// sent must have been received.
inline void on_ranks(std::uint32_t count, const std::function<void(Ranks&)>& work, std::uint32_t of_host = 8) {
    all_devices();  // PoCL 3.1 has no device for threads that ask for the first time while another one does
    Letterbox box;
    std::exception_ptr thrown;
    std::mutex of_thrown;
    std::vector<std::thread> threads;
    for (std::uint32_t rank = 0; rank < count; ++rank)
        threads.emplace_back([&, rank] {
            try {
                Ranks ranks(std::make_unique<ThreadTransport>(box, rank, count, of_host));
                work(ranks);
            } catch (const RankFailure&) {  // because of another one, which tells why
                box.fail();
            } catch (...) {
                const std::lock_guard lock(of_thrown);
                if (!thrown) thrown = std::current_exception();
                box.fail();
            }
        });
    for (std::thread& thread : threads) thread.join();
    if (thrown) std::rethrow_exception(thrown);
    for (const auto& [key, letters] : box.letters)
        if (!letters.empty()) throw std::logic_error("something was sent that nobody received");
}

}  // namespace raya
