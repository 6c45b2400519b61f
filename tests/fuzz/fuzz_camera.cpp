// Fuzz target for camera paths: the reader must either return valid cameras or throw an error with file and line.
#include <algorithm>

#include "host/cli/camera_path.hpp"
#include "host/error.hpp"
#include "host/scene/outline.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace raya;
using namespace raya::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const ScratchFolder folder;
    const std::string_view text = text_of(data, size);
    const std::string file = folder.write("path.txt", text);
    View view;
    view.from = {0, -8, 3};
    view.up = {0, 0, 1};
    try {
        const std::vector<View> cameras = read_camera_path(file, view);
        const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
        if (cameras.empty() || cameras.size() > lines)
            report_finding("the reader returns no camera, or more cameras than lines", text);
        for (const View& camera : cameras)
            if (const std::string reason = view_error(camera); !reason.empty())
                report_finding("an invalid camera is accepted", reason);
    } catch (const UserError& error) {
        const std::string_view message = error.what();
        if (message.find("no camera") != std::string_view::npos)
            check_refusal(message, file);
        else
            check_refusal_with_line(message, file);
    }
    return 0;
}
