// The one door to kernels: it knows sources, build options and the device; each kernel is described once, by its type.
#pragma once
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/error.hpp"

namespace raya {

/// A kernel: its file below kernels/, its name in there, and its parameters as Kernel has them. Parameters of one kind
/// that stand beside each other are named (Uint), so that they cannot change places.
template <FixedText File, FixedText Name, class... Params>
struct DescribedKernel : Kernel<Params...> {
    static constexpr const char* kFile = File.text;

    explicit DescribedKernel(const Program& program)
        : Kernel<Params...>(program.kernel<Params...>(std::string(Name.text))) {}
};

/// Kernels of one build: a program of each file that is asked for, all with the same options.
class Kernels {
  public:
    /// Kernels for the device of `session`, which outlives this. Throws UserError as build_options() does.
    Kernels(Session& session, const KernelOptions& options, const KernelSources& sources = {});

    /// The kernel that `K`, a DescribedKernel, describes. Builds its file if no other kernel of it was asked for
    /// before. Throws UserError (no such file), DeviceError (it does not build, it has another number of parameters).
    template <class K>
    K get() {
        return K(program(K::kFile));
    }

    /// The program of a file below kernels/.
    const Program& program(const std::string& file);

    /// The program of a text that is no file of kernels/ but may include some; `name` stands for it in messages.
    Program build(const std::string& name, const std::string& text) const;

    Session& session() const { return session_; }
    const KernelOptions& options() const { return options_; }

  private:
    Session& session_;
    KernelOptions options_;
    KernelSources sources_;
    std::vector<std::string> build_options_;
    std::map<std::string, Program> programs_;
};

/// `label`: of the step. `remedy`: what gives loops less to do.
inline DeviceError loops_cut(const std::string& label, const std::string& device, const std::string& remedy) {
    return DeviceError("'" + label + "': " + device +
                       " has ended loops early and said nothing, so the image would be wrong; remedy: " + remedy +
                       ", or another device");
}

/// For devices that end a kernel's loops early (kernels/shared/loop_canary.clh): repeats launches whose loops were cut
/// with half the work, a limit that the session keeps. `T`: element types of the buffers that a launch changes, the
/// launch's state.
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
