// Devices that end a kernel's loops early (kernels/shared/loop_canary.clh).
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <tuple>

#include "host/cl/commands.hpp"
#include "host/error.hpp"

namespace raya {

/// `label`: of the step. `remedy`: what gives loops less to do.
inline DeviceError loops_cut(const std::string& label, const std::string& device, const std::string& remedy) {
    return DeviceError("'" + label + "': " + device +
                       " has ended loops early and said nothing, so the image would be wrong; remedy: " + remedy +
                       ", or another device");
}

/// Repeats launches whose loops were cut with half the work, a limit that the session keeps. `T`: element types of the
/// buffers that a launch changes, the launch's state.
template <class... T>
class LaunchGuard {
  public:
    /// Before a launch that is to do so much `work`: returns how much it may do. Copies the state where the device is
    /// known to cut loops.
    std::uint32_t begin(Session& session, const std::string& label, std::uint32_t work, Buffer<T>&... state) {
        const std::uint32_t limit = session.launch_limit(label);
        if (session.device().loop_turns > 0 || limit < UINT32_MAX) {
            if (!copies_) copies_.emplace(session.buffer<T>("copy of " + state.name(), state.size())...);
            std::apply([&](auto&... copy) { (session.copy("save", state, 0, copy, 0, copy.size()), ...); }, *copies_);
        }
        return work_ = std::min(work, limit);
    }

    /// Whether a launch can be repeated.
    bool has_copies() const { return copies_.has_value(); }

    /// After a launch whose loops were cut: goes back to the state before it. Throws loops_cut() where there is no copy
    /// or a launch cannot do less.
    void go_back(Session& session, const std::string& label, const std::string& remedy, Buffer<T>&... state) const {
        if (!copies_ || work_ == 1) throw loops_cut(label, session.device().name, remedy);
        session.launch_limit(label) = work_ / 2;
        std::apply([&](auto&... copy) { (session.copy("restore", copy, 0, state, 0, copy.size()), ...); }, *copies_);
    }

  private:
    std::optional<std::tuple<Buffer<T>...>> copies_;
    std::uint32_t work_ = 0;
};

}  // namespace raya
