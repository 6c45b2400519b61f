#include "host/cli/render_command.hpp"

#include <fmt/core.h>

#include "host/base/json.hpp"
#include "host/base/say.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/measure.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/page.hpp"
#include "host/error.hpp"
#include "host/image/plain_png.hpp"
#include "host/image/preview.hpp"
#include "host/ranks/launch.hpp"
#include "host/report/profile_table.hpp"

namespace raya {
namespace {

void check_packets(const std::string& file) {
    if (!file.ends_with(".gz") && !file.starts_with("/dev/") && !is_standard_stream(file))
        throw UserError(
            fmt::format("--packets {}: what is written is compressed with gzip; let the name end in .csv.gz", file));
}

void check_replay(const CLI::App& parsed, const TorusOptions& t) {
    if (t.replay != "simgrid") throw UserError(fmt::format("--replay {}: must be simgrid", t.replay));
    if (!t.packets.ends_with(".csv.gz"))
        throw UserError(
            "--replay simgrid writes FILE.xml and FILE.replay beside the packets: give --packets FILE.csv.gz");
    const ReplayFiles files(t.packets);
    check_files(parsed, {{"--replay", files.platform}, {"--replay", files.replay}});
}

}  // namespace

void check_targets(const CLI::App& parsed, const RenderCommand& command) {
    const std::string& packets = command.torus.packets;
    if (!launched())  // where mpirun may have put a terminal between itself and us
        for (const std::string& file : {command.image, command.cost, command.mask, packets})
            refuse_bytes_on_terminal(file);
    tone_of(command.tone, command.image);
    if (!packets.empty()) check_packets(packets);
    if (!command.torus.replay.empty()) check_replay(parsed, command.torus);
    if (!command.page.empty()) check_page_name("--page", command.page);
    if (!command.image.empty()) check_image_name(command.image, kImageExtensions);
    if (!command.cost.empty()) check_image_name(command.cost, kGreyImageExtensions);
    if (!command.mask.empty()) check_image_name(command.mask, kImageExtensions);
    if (!command.mask.empty() && command.render.antialias != "supersample")
        throw UserError("--mask shows which pixels were supersampled: give --antialias supersample as well");
}

SceneInput read_scene_once(RenderWatch& watch, RenderOptions& options, Ranks& ranks) {
    SceneInput input;
    if (ranks.first()) {
        input = watch.steps().during("read scene", [&] { return read_scene(options.scene, options.strict); });
        change_view(options.view, input.scene);
    }
    if (!ranks.many()) return input;
    const bool ring = machine_named(options.machine).kind == MachineKind::kRing;
    if (ranks.first() && ring) options.accel = accel_text(ring_settings(options, input.scene).accel);
    ranks.broadcast(input.scene.name);
    ranks.broadcast(input.scene.view.width);
    ranks.broadcast(input.scene.view.height);
    ranks.broadcast(options.accel);
    return input;
}

void add_profile(RenderReport& report, RenderWatch& watch, const cl::Device& device, const NumberFormat& format,
                 const std::vector<KernelWork>& works, Warnings& warnings) {
    report.measured.builds = watch.builds();
    if (!report.ranks.empty()) {  // whose commands are their own, but the works are of all
        report.measured.roofline.emplace().lacking = "it is of one device; start one rank for it";
        return;
    }
    try {
        const DevicePeak peak =
            watch.steps().during("measure peak", [&] { return device_peak(device, format, report.device.lanes); });
        report.measured.roofline = roofline(peak, works, report.measured.commands);
        constexpr double kMuch = 0.15;  // of the best
        if (peak.scatter > kMuch)
            warnings.add(
                fmt::format("the device's peak, measured three times, scatters by {:.0f} %: something else runs on it, "
                            "and shares of the peak say little",
                            100 * peak.scatter));
    } catch (const DeviceError& error) {  // the render's own figures stand
        report.measured.roofline.emplace().lacking = error.what();
    }
}

void add_preview(RenderReport& report, const RenderCommand& command, const Image& image) {
    const Tone tone = tone_of(command.tone, command.image);
    const Image small = preview_of(tone == Tone{} ? image : as_shown(image, tone));
    report.image.preview = {small.width, small.height, plain_png(small)};
}

ImageAttributes image_attributes(const RenderReport& report, const std::string& scene) {
    ImageAttributes attributes = {{"scene", scene},
                                  {"machine", report.machine.name},
                                  {"mapping", report.machine.mapping},
                                  {"format", report.machine.format},
                                  {"u", fmt::format("{:.6f}", report.load.imbalance)}};
    if (report.machine.offset) attributes.emplace_back("offset", std::to_string(*report.machine.offset));
    return attributes;
}

std::optional<ImageCodes> codes_of(const RenderCommand& command) {
    if (command.image.empty() || !holds_codes(command.image)) return {};
    const Tone tone = tone_of(command.tone, command.image);
    return ImageCodes{tone.exposure, tone_curve_name(tone.curve), tone.gamma};
}

void write_main_image(const RenderCommand& command, const Image& image, ImageAttributes attributes) {
    if (command.image.empty()) return;
    const Tone tone = tone_of(command.tone, command.image);
    for (const auto& attribute : tone_attributes(tone)) attributes.push_back(attribute);
    write_image(command.image, image, attributes, tone);
}

void write_report(const RenderCommand& command, const RenderReport& report) {
    if (command.reports()) write_report_and_page({command.report, command.page}, to_json(report));
    if (!is_quiet() && command.summary) fmt::print("{}", printable(human_summary(report)));
    if (!command.profile || !command.prints) return;
    const auto& measured = report.measured;
    fmt::print("\n{}\n{}", profile_table(measured.build_s, measured.builds, measured.commands),
               roofline_table(*measured.roofline));
}

}  // namespace raya
