// State that all images of one command share: the scene, the device, the progress bar and the recorder.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/base/progress.hpp"
#include "host/cl/commands.hpp"
#include "host/cli/render_options.hpp"
#include "host/cli/render_recorder.hpp"
#include "host/cli/scene_input.hpp"
#include "host/cli/tuned_option.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

struct RenderCommand;

/// The progress bar of a render, or the caller's callback instead of it.
class RenderProgress {
  public:
    RenderProgress(bool shows_bar, const std::string& label) : bar_(std::in_place, shows_bar, label) {}
    /// Calls `callback` with the progress instead of showing a bar.
    explicit RenderProgress(ProgressCallback callback) : callback_(std::move(callback)) {}

    /// Sets the bar's label.
    void stage(const std::string& label) {
        if (bar_) bar_->stage(label);
    }

    /// Returns the callback that shows the progress; empty if the progress is not shown.
    ProgressCallback callback();

    /// Erases the bar, so that the summary can be printed.
    void end() { bar_.reset(); }

  private:
    std::optional<ProgressBar> bar_;
    ProgressCallback callback_;
};

/// A command's scene, session and progress.
class RenderRun {
  public:
    /// Reads the scene on rank 0. Throws UserError.
    RenderRun(const RenderCommand& command, Ranks& ranks);

    /// Uses an existing scene, device and session, on a single rank. Device and session must outlive this object.
    RenderRun(const RenderCommand& command, SceneInput scene, const cl::Device& device, Session& session);

    /// Returns the session on the device. The first call loads tuned values and image encoders, and opens the device.
    Session& session();
    const cl::Device& device() const { return device_; }  // valid after the first call of session()

    Ranks& ranks;
    RenderRecorder recorder;
    RenderProgress progress;
    RenderOptions options;  // `accel`: with several ranks, rank 0's choice for the scene
    SceneInput input;       // input.scene.view: the view of the current image

  private:
    Timing timing_;
    std::vector<std::string> image_files_;  // session() loads the encoders of these files
    std::unique_ptr<ScopedTunedSource> tuned_;
    cl::Device device_;
    std::optional<Session> opened_session_;
    Session* session_ = nullptr;
};

}  // namespace raya
