// Checkpoints of long renders: --checkpoint, --resume, --checkpoint-every.
#pragma once
#include <string>

#include "host/base/checkpoint.hpp"
#include "host/base/clock.hpp"

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

/// Removes the checkpoint, if there is one. Call it after all outputs of the render are written.
void remove_checkpoint(const CheckpointOptions& options);

/// Saves and loads the checkpoints of a render.
class CheckpointFile {
  public:
    explicit CheckpointFile(const CheckpointOptions& options);

    /// Returns the callbacks with which the renderer saves and loads checkpoints; null without --checkpoint.
    const Checkpointing* checkpointing() const { return options_.file.empty() ? nullptr : &callbacks_; }

  private:
    bool due();  // returns true if the next checkpoint is due
    void save(const std::string& bytes);
    void load(const std::function<RenderedPart(std::string_view bytes)>& read) const;

    const CheckpointOptions& options_;
    Checkpointing callbacks_;
    Clock::time_point last_save_end_ = Clock::now();  // before the first save: time of construction
    Clock::time_point due_at_;                        // time of the last call of due(), which precedes a save
    double last_save_duration_s_ = 0;                 // of collecting and writing the state, seconds
};

}  // namespace raya
