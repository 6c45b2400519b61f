// Fuzz target for frame records as `raya render --frames` reads them. The reader must throw an error or return a
// record. If the record is written and read again, it must not change.
#include "host/base/whole_file.hpp"
#include "host/cli/frame_record.hpp"
#include "host/error.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace raya;
using namespace raya::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const ScratchFolder folder;
    static const std::string frame = folder.write("frame-0001.ppm", "P6");
    const std::string file = folder.write("frames.json", text_of(data, size));
    try {
        FrameRecord record(file);
        for (const std::uint32_t number : {0u, 1u, UINT32_MAX}) {
            record.find(number, "settings", {});
            record.find(number, "settings", {frame});
        }
        record.write();
        const std::string written = read_file(file);
        FrameRecord reread(file);
        reread.write();
        if (read_file(file) != written)
            report_finding("a frame record changes if it is written and read again", written);
        reread.add({.number = 1, .settings = "settings", .pixels = {}, .files = {}}, {frame});
        reread.write();
        if (reread.find(1, "settings", {frame}) == nullptr)
            report_finding("a frame that was added is not found", written);
        if (reread.find(1, "others", {frame}) != nullptr) report_finding("a frame of other settings is found", written);
        if (FrameRecord(file + ".none").find(1, "settings", {}) != nullptr)
            report_finding("a frame is found without a record", written);
    } catch (const UserError& error) {
        check_refusal(error.what(), file);
    }
    return 0;
}
