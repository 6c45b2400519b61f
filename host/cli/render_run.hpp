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

/// The progress bar of a command that renders one image or a sequence.
class RenderProgress {
  public:
    RenderProgress(bool wanted, const std::string& what) : bar_(std::in_place, wanted, what) {}
    /// Calls `callback` with the progress instead of showing a bar.
    explicit RenderProgress(ProgressCallback callback) : callback_(std::move(callback)) {}

    /// Sets the bar's label to the current stage of a single image. In a sequence the label is the number of images.
    void stage(const std::string& what);

    /// Starts a sequence: from now on the bar shows how many of `count` images are finished.
    void begin_images(std::size_t count);
    void next_image();

    /// Returns the callback that shows the progress of the current image; empty if the progress is not shown.
    ProgressCallback callback();

    /// Erases the bar of a single image, before its summary is printed. The bar of a sequence remains, below its lines.
    void end();

  private:
    std::optional<ProgressBar> bar_;
    ProgressCallback callback_;
    std::size_t images_ = 0, done_ = 0;  // images of the sequence (0: a single image), finished ones
};

class RenderRun {
  public:
    /// Reads the scene on rank 0. Throws UserError.
    RenderRun(const RenderCommand& command, Ranks& ranks);

    /// For one rank, with an existing scene, device and session. Device and session must outlive this object.
    RenderRun(const RenderCommand& command, SceneInput scene, const cl::Device& device, Session& session);

    /// Returns the session on the device. The first call loads tuned values and image encoders, and opens the device.
    /// All images of a sequence share the session and its programs.
    Session& session();
    const cl::Device& device() const { return device_; }  // valid after the first session()

    Ranks& ranks;
    RenderRecorder recorder;
    RenderProgress progress;
    RenderOptions options;  // with the default of --accel that rank 0 chose for the scene
    SceneInput input;       // its view is that of the current image

  private:
    Timing timing_;
    std::vector<std::string> images_;  // image files of the command, for their encoders
    std::unique_ptr<ScopedTunedSource> tuned_;
    cl::Device device_;
    std::optional<Session> opened_session_;
    Session* session_ = nullptr;
};

}  // namespace raya
