// Typed access to kernels: each kernel is declared once, as a type with its file, name and parameters.
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

/// A kernel: its file below kernels/, its name in that file, and its parameter types as in Kernel. The types of
/// adjacent uint parameters contain the parameters' names (Uint), so that a caller cannot swap the arguments.
template <FixedText File, FixedText Name, class... Params>
struct DescribedKernel : Kernel<Params...> {
    static constexpr const char* kFile = File.text;

    explicit DescribedKernel(const Program& program)
        : Kernel<Params...>(program.kernel<Params...>(std::string(Name.text))) {}
};

/// The kernels for one device with one set of build options. Each requested file is built as one program.
class Kernels {
  public:
    /// Makes kernels for the device of `session`, which must outlive this object. Throws as build_options().
    Kernels(Session& session, const KernelOptions& options, const KernelSources& sources = {});

    /// Returns the kernel `K`, a DescribedKernel. Builds its file when the first of the file's kernels is requested.
    /// Throws UserError if there is no such file, DeviceError if the build fails or the number of parameters differs.
    template <class K>
    K get() {
        return K(program(K::kFile));
    }

    /// Returns the program built from a file below kernels/. Throws as get().
    const Program& program(const std::string& file);

    /// Builds the source `text`, which is not a file of kernels/ but may include such files; `name` is for messages.
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

/// Returns the error for a launch whose loops the device has ended early. `label`: label of the launch; `remedy`: a
/// change that shortens the loops.
inline DeviceError truncated_loops_error(const std::string& label, const std::string& device,
                                         const std::string& remedy) {
    return DeviceError(
        "'" + label + "': " + device +
        " stopped this kernel's loops before their end and reported no error; the image would be wrong; remedy: " +
        remedy + ", or another device");
}

/// Guards launches on devices that end a kernel's loops early (kernels/shared/loop_canary.clh). After a launch whose
/// loops were truncated, the guard restores the buffers that the launch changes (the state) and halves the limit of
/// work per launch, so that the caller can repeat the launch. The session stores the limit (Session::launch_limit()).
/// `T...`: element types of the state's buffers.
template <class... T>
class LaunchGuard {
  public:
    /// Call before a launch. Returns the amount of work that the launch may do, at most `work`. Saves the state if the
    /// device is known to truncate loops.
    std::uint32_t begin(Session& session, const std::string& label, std::uint32_t work, Buffer<T>&... state) {
        const std::uint32_t limit = session.launch_limit(label);
        if (session.device().max_loop_iterations > 0 || limit < UINT32_MAX) {
            if (!copies_) copies_.emplace(session.buffer<T>("copy of " + state.name(), state.size())...);
            std::apply([&](auto&... copy) { (session.copy("save", state, 0, copy, 0, copy.size()), ...); }, *copies_);
        }
        return work_ = std::min(work, limit);
    }

    /// Returns true if the state was saved, so that a launch can be repeated.
    bool has_copies() const { return copies_.has_value(); }

    /// Call after a launch whose loops were truncated. Restores the state to that before the launch and sets the limit
    /// to half the launch's work. Throws truncated_loops_error() if the state was not saved or the work was 1.
    void restore_state(Session& session, const std::string& label, const std::string& remedy,
                       Buffer<T>&... state) const {
        if (!copies_ || work_ == 1) throw truncated_loops_error(label, session.device().name, remedy);
        session.launch_limit(label) = work_ / 2;
        std::apply([&](auto&... copy) { (session.copy("restore", copy, 0, state, 0, copy.size()), ...); }, *copies_);
    }

  private:
    std::optional<std::tuple<Buffer<T>...>> copies_;
    std::uint32_t work_ = 0;
};

}  // namespace raya
