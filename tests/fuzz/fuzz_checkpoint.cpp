// Fuzz target for checkpoints as `raya render --resume` reads them. The reader must throw an error or return the
// vectors of this render. If they are written and read again, they must not change.
#include "host/base/log.hpp"
#include "host/cli/render_command.hpp"
#include "host/error.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace raya;
using namespace raya::fuzz;

namespace {

struct Vectors {
    RenderedPart part{};
    std::vector<std::uint32_t> numbers;
    std::vector<float> image = std::vector<float>(3);
    std::vector<std::uint64_t> cycles = std::vector<std::uint64_t>(2);
};

Vectors read(std::string_view bytes, const StateSettings& settings) {
    CheckpointReader reader(bytes, settings);
    Vectors v{.part = reader.part(), .numbers = reader.take_any<std::uint32_t>()};
    reader.take(v.image);
    reader.take(v.cycles);
    reader.check_end();
    return v;
}

std::string written(const Vectors& v, const StateSettings& settings) {
    CheckpointWriter writer(settings, v.part);
    writer.put(v.numbers);
    writer.put(v.image);
    writer.put(v.cycles);
    return writer.finish();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const ScratchFolder folder;
    static const StateSettings settings = {
        {"image", "4 x 4"}, {"--cost", "yes"}, {"--strict", "no"}, {"another scene", "a"}};
    set_verbosity(kErrorsOnly);
    const CheckpointOptions options{.file = folder.write("render.rst", text_of(data, size)), .resume = true};
    const auto checkpointing = checkpointing_of(options);
    try {
        bool found = false;
        checkpointing->resume([&](std::string_view bytes) {
            found = true;
            const Vectors vectors = read(bytes, settings);
            const std::string again = written(vectors, settings);
            if (written(read(again, settings), settings) != again)
                report_finding("a checkpoint changes if it is written and read again",
                               text_of(data, size).substr(0, 200));
            return vectors.part;
        });
        if (!found) report_finding("an existing checkpoint is not found", options.file);
    } catch (const UserError& error) {
        check_refusal(error.what(), options.file);
    }
    return 0;
}
