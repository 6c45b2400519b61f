#include "verify/verify.hpp"

#include "cl/kernel_source.hpp"

namespace raya {

Verification::Verification(const cl::Device& device, const VerifySettings& settings, const CheckSink& finished)
    : device_(device), info_(device_info(device)), settings_(settings), finished_(finished) {}

void Verification::check(const std::string& layer, const std::string& name,
                         const std::function<Verdict(Session&)>& body) {
    if ((layer + " " + name).find(settings_.only) == std::string::npos) return;
    checks_.push_back(run_check(layer, name, [&] {
        Session session(device_);
        const Verdict verdict = body(session);
        session.finish();
        return verdict;
    }));
    if (finished_) finished_(checks_.back());
}

Program Verification::build(Session& session, const std::string& file, std::vector<std::string> options) const {
    options.insert(options.end(), settings_.breakage.options.begin(), settings_.breakage.options.end());
    return session.build(file, kernel_source(file, settings_.kernel_dir), options);
}

KernelChoice Verification::kernels(std::uint32_t lanes, std::uint32_t group_size) const {
    return {.lanes = lanes ? lanes : settings_.lanes,
            .group_size = group_size,
            .kernel_dir = settings_.kernel_dir,
            .more_options = settings_.breakage.options};
}

std::vector<std::uint32_t> Verification::lanes() const {
    if (full() && settings_.lanes == 0) return {1, 4, 8, 16};
    return {own_lanes()};
}

std::vector<Check> verify(const cl::Device& device, const VerifySettings& settings, const CheckSink& finished) {
    Verification verification(device, settings, finished);
    verify_numbers(verification);
    verify_geometry(verification);
    verify_machines(verification);
    verify_images(verification);
    return verification.take_checks();
}

}  // namespace raya
