// Fuzz target for checkpoints as `raya render --resume` reads them. The reader must throw an error or return a
// checkpoint of this render. If the checkpoint is written and read again, it must not change.
#include "host/base/log.hpp"
#include "host/cli/checkpoint_options.hpp"
#include "host/error.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace raya;
using namespace raya::fuzz;

namespace {

// Returns a state whose vectors have the sizes of those in the corpus's checkpoints.
RingState expected_sizes() {
    RingState state;
    state.image.resize(3);
    state.pixels.resize(2);
    state.marks.resize(3);
    state.passes.resize(2);
    state.passes[0].cycles.resize(2);
    state.passes[0].events.resize(2);
    state.passes[1].costs.resize(1);
    state.all_costs.resize(1);
    return state;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const ScratchFolder folder;
    static const StateSettings settings = {
        {"image", "4 x 4"}, {"--cost", "yes"}, {"--strict", "no"}, {"another scene", "a"}};
    set_verbosity(kErrorsOnly);
    const CheckpointOptions options{.file = folder.write("render.rst", text_of(data, size)), .resume = true};
    try {
        const CheckpointFile file(options);
        const auto state = file.checkpointing()->resume(settings, expected_sizes());
        if (!state) report_finding("an existing checkpoint is not found", options.file);
        const std::string written = state_bytes(*state, settings);
        if (state_bytes(read_state(written, settings, expected_sizes()), settings) != written)
            report_finding("a checkpoint changes if it is written and read again", text_of(data, size).substr(0, 200));
    } catch (const UserError& error) {
        check_refusal(error.what(), options.file);
    }
    return 0;
}
