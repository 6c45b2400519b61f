// Loops whose iterations run on several threads, and a timer.
#pragma once
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace raya {

/// Returns the number of cores that this process may use, at least 1.
unsigned core_count();

/// Calls work(i) once for each i in 0 .. count - 1, on up to `threads` threads; the calling thread is one of them. The
/// threads take the indices in ascending order. If a call throws, no further calls start, and the exception is thrown
/// to the caller; of several exceptions, one.
void parallel_for(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work);

/// Calls `action` in a thread after `delay_s` seconds, unless the returned object is destroyed before.
[[nodiscard]] inline std::jthread call_after(double delay_s, std::function<void()> action) {
    return std::jthread([delay_s, action = std::move(action)](const std::stop_token& cancelled) {
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any().wait_for(lock, cancelled, std::chrono::duration<double>(delay_s),
                                               [] { return false; });
        if (!cancelled.stop_requested()) action();
    });
}

/// The indices begin .. end - 1.
struct IndexRange {
    std::size_t begin, end;
    std::size_t size() const { return end - begin; }
};

/// Returns part i of the indices 0 .. count - 1, which are divided into `parts` consecutive ranges of about equal size.
constexpr IndexRange part_of_range(std::size_t i, std::size_t parts, std::size_t count) {
    return {i * count / parts, (i + 1) * count / parts};
}

/// Calls work(i) once for each i in 0 .. count - 1, on up to `threads` threads, each of which takes parts of about
/// `min_part` or more consecutive indices.
template <class Work>
void parallel_for_items(std::size_t count, unsigned threads, std::size_t min_part, const Work& work) {
    const std::size_t parts = std::min<std::size_t>(16 * threads, 1 + count / min_part);
    parallel_for(parts, threads, [&](std::size_t part) {
        const auto [begin, end] = part_of_range(part, parts, count);
        for (std::size_t i = begin; i < end; ++i) work(i);
    });
}

// Vectors whose memory is in huge pages.

/// Asks the system to use huge pages for memory that nothing has accessed yet. Does nothing if the system has none.
void advise_huge_pages(void* memory, std::size_t bytes);

/// Reserves space for `count` elements of an empty vector, in huge pages: the first access to memory in small pages
/// takes longer than many a render.
template <class T>
void reserve_in_huge_pages(std::vector<T>& elements, std::size_t count) {
    elements.reserve(count);
    advise_huge_pages(elements.data(), count * sizeof(T));
}

/// Resizes a vector, which if it is empty gets memory in huge pages.
template <class T>
void resize_in_huge_pages(std::vector<T>& elements, std::size_t count) {
    if (elements.empty()) reserve_in_huge_pages(elements, count);
    elements.resize(count);
}

}  // namespace raya
