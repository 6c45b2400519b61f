#include "host/verify/verify.hpp"

namespace raya {

namespace {

void visit_layers(Verification& verification) {
    verify_numbers(verification);
    verify_geometry(verification);
    verify_machines(verification);
    verify_images(verification);
}

}  // namespace

const char* depth_name(Depth depth) {
    switch (depth) {
        case Depth::kBrief:
            return "brief";
        case Depth::kQuick:
            return "quick";
        case Depth::kFull:
            return "full";
    }
    return "";
}

Verification::Verification(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink, bool runs)
    : device_(device), info_(device_info(device)), settings_(settings), sink_(sink), runs_(runs) {
    check_patches(settings.sources);  // else one that does not fit would look like a fault seen
}

void Verification::check(const std::string& layer, const std::string& name,
                         const std::function<Verdict(Session&)>& body) {
    const std::string full_name = layer + " " + name;
    if (full_name.find(settings_.only) == std::string::npos) return;
    names_.push_back(full_name);
    if (!runs_ || names_.size() <= settings_.done) return;
    if (sink_.started) sink_.started(layer, name);
    checks_.push_back(run_check(layer, name, [&] {
        Session session(device_);
        const Verdict verdict = body(session);
        session.finish();
        return verdict;
    }));
    if (sink_.finished) sink_.finished(checks_.back());
}

KernelChoice Verification::kernels(std::uint32_t lanes, std::uint32_t group_size) const {
    return {.lanes = lanes ? lanes : settings_.lanes, .group_size = group_size, .sources = settings_.sources};
}

std::vector<std::uint32_t> Verification::lanes() const {
    if (full() && settings_.lanes == 0) return {1, 4, 8, 16};
    return {own_lanes()};
}

std::vector<std::string> Verification::lanes_remedies(std::uint32_t lanes) const {
    if (lanes <= 1) return {};
    if (full() && settings_.lanes == 0) return {"are checks with fewer lanes right? then give --lanes"};
    return {"raya verify --lanes 1: are fewer lanes right? then give --lanes"};
}

std::vector<Check> verify(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink) {
    Verification verification(device, settings, sink);
    visit_layers(verification);
    return verification.take_checks();
}

std::vector<std::string> check_names(const cl::Device& device, const VerifySettings& settings) {
    Verification verification(device, settings, {}, false);
    visit_layers(verification);
    return verification.take_names();
}

}  // namespace raya
