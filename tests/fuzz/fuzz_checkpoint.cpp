// Checkpoints, as `raya render --resume` reads them: any bytes are a checkpoint of this render or refused; one that was
// read survives being written.
#include "host/base/say.hpp"
#include "host/cli/keep_options.hpp"
#include "host/error.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace raya;
using namespace raya::fuzz;

namespace {

// What the corpus has.
RingState sizes() {
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
    set_verbosity(kSilent);
    const KeepOptions options{.file = folder.write("render.rst", text_of(data, size)), .resume = true};
    try {
        const StateFile file(options);
        const auto state = file.keeping()->resume(settings, sizes());
        if (!state) complain("the file is not there", options.file);
        const std::string written = state_bytes(*state, settings);
        if (state_bytes(read_state(written, settings, sizes()), settings) != written)
            complain("changed by being written and read", text_of(data, size).substr(0, 200));
    } catch (const UserError& error) {
        check_refusal(error.what(), options.file);
    }
    return 0;
}
