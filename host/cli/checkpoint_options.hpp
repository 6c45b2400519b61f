// Checkpoints of long renders: --checkpoint, --resume, --checkpoint-every.
#pragma once
#include <string>

#include "host/base/clock.hpp"
#include "host/ring/ring_state.hpp"

namespace CLI {
class App;
}

namespace raya {

/// The options as given on the command line. An empty `file` means no checkpoints.
struct CheckpointOptions {
    std::string file;
    bool resume = false;
    double every_s = 10;  // minimum seconds between two checkpoints
};

void add_checkpoint_options(CLI::App& command, CheckpointOptions& options);

/// Throws UserError for incompatible options and for an existing file that is not a checkpoint. Without --resume, also
/// throws UserError for an existing checkpoint, because the render would overwrite hours of work.
void check_checkpoint_options(const CLI::App& command, const CheckpointOptions& options);

/// Saves and loads the checkpoints of a render.
class CheckpointFile {
  public:
    explicit CheckpointFile(const CheckpointOptions& options);

    /// Returns the callbacks with which the renderer saves and loads checkpoints; null without --checkpoint.
    const RingCheckpointing* checkpointing() const { return options_.file.empty() ? nullptr : &callbacks_; }

    /// Removes the checkpoint. Call remove() after all outputs of the render are written.
    void remove() const;

  private:
    bool due() const;  // returns true if the next checkpoint is due
    void save(const RingState& state, const StateSettings& settings);
    std::optional<RingState> load(const StateSettings& settings, const RingState& expected_sizes) const;

    const CheckpointOptions& options_;
    RingCheckpointing callbacks_;
    Clock::time_point last_save_end_ = Clock::now();  // before the first save: time of construction
    double last_save_duration_s_ = 0;                 // seconds
};

}  // namespace raya
