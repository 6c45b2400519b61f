// An end for calls that have none of their own, such as MPI's beginning and its end.
#pragma once
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace raya {

/// Ends the process with `code` where it lives longer than `limit_s` seconds, and says `text` on stderr before; empty:
/// nothing.
class Deadline {
  public:
    Deadline(double limit_s, std::string text, int code)
        : watch_([this, limit_s, text = std::move(text), code] {
              std::unique_lock lock(mutex_);
              if (ended_.wait_for(lock, std::chrono::duration<double>(limit_s), [this] { return over_; })) return;
              if (!text.empty() && ::write(STDERR_FILENO, text.data(), text.size()) < 0) std::_Exit(code);  // unheard
              std::_Exit(code);
          }) {}
    ~Deadline() {
        {
            const std::lock_guard lock(mutex_);
            over_ = true;
        }
        ended_.notify_one();
        watch_.join();
    }
    Deadline(const Deadline&) = delete;
    Deadline& operator=(const Deadline&) = delete;

  private:
    std::mutex mutex_{};
    std::condition_variable ended_{};
    bool over_ = false;
    std::thread watch_;  // last: it uses the others
};

}  // namespace raya
