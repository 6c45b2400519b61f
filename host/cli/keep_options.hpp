// A long image that may be stopped and go on: --keep, --resume, --keep-every.
#pragma once
#include <string>

#include "host/base/clock.hpp"
#include "host/ring/ring_state.hpp"

namespace CLI {
class App;
}

namespace raya {

/// As given on the command line; no `file`: nothing is kept.
struct KeepOptions {
    std::string file;
    bool resume = false;
    double every_s = 10;
};

void add_keep_options(CLI::App& command, KeepOptions& keep);

/// Refuses what does not go together, a file that cannot be written, and one that is there although nothing is to be
/// resumed: it may hold hours of work. UserError.
void check_keep(const CLI::App& command, const KeepOptions& keep);

/// The file that a render's state is kept in, while it renders.
class StateFile {
  public:
    explicit StateFile(const KeepOptions& options);

    /// What the renderer is given; a null pointer where nothing is kept.
    const RingKeeping* keeping() const { return options_.file.empty() ? nullptr : &keeping_; }

    /// Once all that the render makes is written.
    void remove() const;

  private:
    bool due() const;
    void keep(const RingState& state, const StateSettings& settings);
    std::optional<RingState> read(const StateSettings& settings, const RingState& like) const;

    const KeepOptions& options_;
    RingKeeping keeping_;
    Clock::time_point kept_ = Clock::now();
    double keeping_s_ = 0;  // that the last one took
};

}  // namespace raya
