// What the images of one command have in common: the scene, read once, the device, opened once, and who watches.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/base/progress.hpp"
#include "host/cl/commands.hpp"
#include "host/cli/render_options.hpp"
#include "host/cli/render_watch.hpp"
#include "host/cli/scene_input.hpp"
#include "host/cli/tuned_option.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

struct RenderCommand;

/// How far a command has come, of one image or of many, for a person at a terminal.
class RenderProgress {
  public:
    RenderProgress(bool wanted, const std::string& what) : bar_(std::in_place, wanted, what) {}
    /// For a caller that shows it.
    explicit RenderProgress(ProgressCallback callers) : callers_(std::move(callers)) {}

    /// What runs from now on; of several images their number stands there.
    void stage(const std::string& what);

    /// From now on the bar shows how many of so many images are done.
    void begin_images(std::size_t count);
    void next_image();

    /// Of the image at hand; empty where nobody looks.
    ProgressCallback callback();

    /// Erases the bar: what follows is printed. Of several images nothing: their lines are printed above it.
    void end();

  private:
    std::optional<ProgressBar> bar_;
    ProgressCallback callers_;
    std::size_t images_ = 0, done_ = 0;  // 0: one image, which is shown stage by stage
};

class RenderRun {
  public:
    /// Reads the scene: rank 0 does. UserError.
    RenderRun(const RenderCommand& command, Ranks& ranks);

    /// Of one rank, with a scene that is there and a device that is open; both outlive this.
    RenderRun(const RenderCommand& command, SceneInput scene, const cl::Device& device, Session& session);

    /// The device, opened at the first call with all that renders take from it, and what encodes the pictures. Of
    /// several images the programs are built once.
    Session& session();
    const cl::Device& device() const { return device_; }  // of the session, once it is open

    Ranks& ranks;
    RenderWatch watch;
    RenderProgress progress;
    RenderOptions options;  // with what rank 0 chose by the scene
    SceneInput input;       // the scene as it is seen in the image at hand

  private:
    Timing timing_;
    std::vector<std::string> pictures_;
    std::unique_ptr<TunedUse> tuned_;
    cl::Device device_;
    std::optional<Session> own_session_;
    Session* session_ = nullptr;
};

}  // namespace raya
