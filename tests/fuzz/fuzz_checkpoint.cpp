// Fuzz target for checkpoints as `raya render --resume` reads them, of a ring and of a torus with one node. The reader
// must throw an error or return a checkpoint of this render. If the checkpoint is written and read again, it must not
// change.
#include "host/base/log.hpp"
#include "host/cli/checkpoint_options.hpp"
#include "host/error.hpp"
#include "host/ring/ring_state.hpp"
#include "host/torus/torus_state.hpp"
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
    const CheckpointFile file(options);
    const auto check = [&](const auto& read, const auto& write) {
        try {
            bool found = false;
            file.checkpointing()->resume([&](std::string_view bytes) {
                found = true;
                const auto state = read(bytes);
                const std::string written = write(state);
                if (write(read(written)) != written)
                    report_finding("a checkpoint changes if it is written and read again",
                                   text_of(data, size).substr(0, 200));
                return state.part;
            });
            if (!found) report_finding("an existing checkpoint is not found", options.file);
        } catch (const UserError& error) {
            check_refusal(error.what(), options.file);
        }
    };
    check([](std::string_view bytes) { return read_state(bytes, settings, expected_sizes()); },
          [](const RingState& s) { return state_bytes(s, settings); });
    check([](std::string_view bytes) { return read_state(bytes, settings, 1, {.queue = 2, .box = 1}); },
          [](const TorusState& s) { return state_bytes(s.run, s.nodes, s.part, settings); });
    return 0;
}
