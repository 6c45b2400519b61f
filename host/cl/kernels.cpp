#include "host/cl/kernels.hpp"

namespace raya {

Kernels::Kernels(Session& session, const KernelOptions& options, const KernelSources& sources)
    : session_(session),
      options_(options),
      sources_(sources),
      build_options_(build_options(options, session.device())) {
    build_options_.insert(build_options_.end(), sources.more_options.begin(), sources.more_options.end());
}

const Program& Kernels::program(const std::string& file) {
    const auto found = programs_.find(file);
    if (found != programs_.end()) return found->second;
    const Program program = session_.build(file, kernel_source(file, sources_), build_options_);
    return programs_.emplace(file, program).first->second;
}

Program Kernels::build(const std::string& name, const std::string& text) const {
    return session_.build(name, expand_kernel_source(text, name, sources_), build_options_);
}

}  // namespace raya
