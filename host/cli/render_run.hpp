// State shared by the images of one command: the scene, the device, the progress bar and the recorder.
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
    /// Reports to the caller's callback instead of a bar.
    explicit RenderProgress(ProgressCallback callback) : callback_(std::move(callback)) {}

    /// Sets the label of the current stage; a sequence keeps the number of its images as label.
    void stage(const std::string& what);

    /// Makes the bar show finished images of `count`.
    void begin_images(std::size_t count);
    void next_image();

    /// Progress of the current image; empty if it is not shown.
    ProgressCallback callback();

    /// Erases the bar of a single image before its summary; a sequence keeps the bar below its lines.
    void end();

  private:
    std::optional<ProgressBar> bar_;
    ProgressCallback callback_;
    std::size_t images_ = 0, done_ = 0;  // 0: a single image, shown by stages
};

class RenderRun {
  public:
    /// Reads the scene on rank 0. UserError.
    RenderRun(const RenderCommand& command, Ranks& ranks);

    /// One rank, with a scene that was read and a device that is open; device and session must outlive this.
    RenderRun(const RenderCommand& command, SceneInput scene, const cl::Device& device, Session& session);

    /// The session on the device. The first call opens it, applies tuned values, and loads the image encoders. The
    /// images of a sequence share its programs.
    Session& session();
    const cl::Device& device() const { return device_; }  // valid once the session is open

    Ranks& ranks;
    RenderRecorder recorder;
    RenderProgress progress;
    RenderOptions options;  // with the defaults that rank 0 chose from the scene
    SceneInput input;       // with the view of the current image

  private:
    Timing timing_;
    std::vector<std::string> images_;
    std::unique_ptr<ScopedTunedSource> tuned_;
    cl::Device device_;
    std::optional<Session> own_session_;
    Session* session_ = nullptr;
};

}  // namespace raya
