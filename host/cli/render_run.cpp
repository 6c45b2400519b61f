#include "host/cli/render_run.hpp"

#include <fmt/core.h>

#include "host/cl/device.hpp"
#include "host/cli/render_command.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

void require_host_device(const cl::Device& device) {
    const DeviceInfo info = device_info(device);
    if (info.type != "cpu")
        throw UserError(
            fmt::format("--counters: {} is not a CPU, and only events of the host's processor are counted; remedy: "
                        "--device cpu, or the profiler of the device's vendor (docs/profile.md)",
                        info.name));
}

}  // namespace

ProgressCallback RenderProgress::callback() {
    if (!bar_ || !bar_->active()) return callback_;
    return [this](double fraction) { bar_->update(fraction); };
}

RenderRun::RenderRun(const RenderCommand& command, Ranks& all_ranks)
    : ranks(all_ranks),
      recorder(command.trace, command.needs_roofline(), command.counters),
      progress(all_ranks.is_first(), "reading the scene"),
      options(command.render),
      input(read_scene_on_rank_0(recorder, options, all_ranks)),
      timing_(command.timing()),
      image_files_{command.image, command.cost, command.mask} {}

RenderRun::RenderRun(const RenderCommand& command, SceneInput scene, const cl::Device& device, Session& session)
    : ranks(Ranks::single()),
      recorder(command.trace, command.needs_roofline(), false),
      progress(command.progress),
      options(command.render),
      input(std::move(scene)),
      timing_(command.timing()),
      device_(device),
      session_(&session) {
    change_view(options.view, input.scene);
    tuned_.reset(new ScopedTunedSource(use_tuned(options.no_tuned, &input.warnings)));
    warn_of_build_options(input.warnings);
    recorder.observe(session, ranks);
}

Session& RenderRun::session() {
    if (session_ != nullptr) return *session_;
    tuned_.reset(new ScopedTunedSource(use_tuned(options.no_tuned, &input.warnings)));
    if (ranks.is_first()) warn_of_build_options(input.warnings);
    progress.stage("preparing");
    device_ =
        recorder.spans().during("choose device", [&] { return choose_device(options.device, ranks.rank_on_host()); });
    if (recorder.host_counters() != nullptr) require_host_device(device_);
    // OpenImageIO must be loaded after the OpenCL drivers: both use TBB, a process keeps the first TBB that it loads,
    // and Intel's OpenCL runtime needs a newer TBB than OpenImageIO.
    for (const std::string& file : image_files_)
        if (ranks.is_first() && !file.empty()) load_encoder(file);
    opened_session_.emplace(recorder.spans().during("open device", [&] { return Session(device_, timing_); }));
    session_ = &*opened_session_;
    if (ranks.is_first()) session_->announce_compiling();
    recorder.observe(*session_, ranks);
    return *session_;
}

}  // namespace raya
