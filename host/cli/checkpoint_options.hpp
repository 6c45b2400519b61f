// Checkpoints of long renders: --checkpoint, --resume, --checkpoint-every.
#pragma once
#include <string>

#include "host/base/clock.hpp"
#include "host/ring/ring_state.hpp"

namespace CLI {
class App;
}

namespace raya {

/// As given on the command line; no checkpoints if `file` is empty.
struct CheckpointOptions {
    std::string file;
    bool resume = false;
    double every_s = 10;
};

void add_checkpoint_options(CLI::App& command, CheckpointOptions& options);

/// Refuses incompatible options, a file that is not a checkpoint, and an existing checkpoint without --resume: it may
/// hold hours of work. UserError.
void check_checkpoint_options(const CLI::App& command, const CheckpointOptions& options);

/// Saves and loads the checkpoints of a render.
class CheckpointFile {
  public:
    explicit CheckpointFile(const CheckpointOptions& options);

    /// The renderer's hooks; null without --checkpoint.
    const RingCheckpointing* checkpointing() const { return options_.file.empty() ? nullptr : &hooks_; }

    /// Removes the file, after all outputs of the render are written.
    void remove() const;

  private:
    bool due() const;
    void save(const RingState& state, const StateSettings& settings);
    std::optional<RingState> load(const StateSettings& settings, const RingState& like) const;

    const CheckpointOptions& options_;
    RingCheckpointing hooks_;
    Clock::time_point saved_ = Clock::now();
    double save_s_ = 0;  // duration of the last save
};

}  // namespace raya
