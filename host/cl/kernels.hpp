// The one door to kernels: it knows sources, build options and the device; each kernel is described once, by its type.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cl/kernel_source.hpp"

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

}  // namespace raya
