#include "host/cli/render_command.hpp"

#include <fmt/core.h>

#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/page.hpp"
#include "host/error.hpp"
#include "host/image/plain_png.hpp"
#include "host/image/preview.hpp"
#include "host/ranks/launch.hpp"
#include "host/report/profile_table.hpp"

namespace raya {
namespace {

void check_packets_name(const std::string& file) {
    if (!file.ends_with(".gz") && !file.starts_with("/dev/") && !is_standard_stream(file))
        throw UserError(
            fmt::format("--packets {}: raya compresses this file with gzip; choose a name that ends in .csv.gz", file));
}

void check_replay(const CLI::App& parser, const TorusOptions& t) {
    if (t.replay != "simgrid") throw UserError(fmt::format("--replay {}: must be simgrid", t.replay));
    if (!t.packets.ends_with(".csv.gz"))
        throw UserError(
            "--replay simgrid writes FILE.xml and FILE.replay next to the packets: add --packets FILE.csv.gz");
    const ReplayFiles files(t.packets);
    check_files(parser, {{"--replay", files.platform}, {"--replay", files.replay}});
}

}  // namespace

void check_output_files(const CLI::App& parser, const RenderCommand& command) {
    const std::string& packets = command.torus.packets;
    if (!find_launch())  // under mpirun, stdout may be a pseudoterminal although the output goes to a file
        for (const std::string& file : {command.image, command.cost, command.mask, packets})
            refuse_bytes_on_terminal(file);
    tone_of(command.tone, command.image);  // throws UserError for invalid tone options
    if (!packets.empty()) check_packets_name(packets);
    if (!command.torus.replay.empty()) check_replay(parser, command.torus);
    if (!command.page.empty()) check_page_name("--page", command.page);
    if (!command.image.empty()) check_image_name(command.image, kImageExtensions);
    if (!command.cost.empty()) check_image_name(command.cost, kGreyImageExtensions);
    if (!command.mask.empty()) check_image_name(command.mask, kImageExtensions);
    if (!command.mask.empty() && command.render.antialias != "supersample")
        throw UserError("--mask requires supersampling: add --antialias supersample");
}

SceneInput read_scene_on_rank_0(RenderRecorder& recorder, RenderOptions& options, Ranks& ranks) {
    SceneInput input;
    if (ranks.is_first()) {
        input = recorder.spans().during("read scene", [&] { return read_scene(options.scene, options.strict); });
        change_view(options.view, input.scene);
    }
    if (!ranks.has_several()) return input;
    const bool ring = machine_named(options.machine).kind == MachineKind::kRing;
    if (ranks.is_first() && ring) options.accel = accel_text(ring_settings(options, input.scene).accel);
    ranks.broadcast(input.scene.name);
    ranks.broadcast(input.scene.view.width);
    ranks.broadcast(input.scene.view.height);
    ranks.broadcast(options.accel);
    return input;
}

void add_preview(RenderReport& report, const RenderCommand& command, const Image& image) {
    const Tone tone = tone_of(command.tone, command.image);
    const Image preview = preview_of(tone == Tone{} ? image : as_displayed(image, tone));
    report.image.preview = {preview.width, preview.height, plain_png(preview)};
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

std::optional<CodeConversion> code_conversion_of(const RenderCommand& command) {
    if (command.image.empty() || !stores_8bit_codes(command.image)) return {};
    const Tone tone = tone_of(command.tone, command.image);
    return CodeConversion{tone.exposure, tone_curve_name(tone.curve), tone.gamma};
}

void write_main_image(const RenderCommand& command, const Image& image, ImageAttributes attributes) {
    if (command.image.empty()) return;
    const Tone tone = tone_of(command.tone, command.image);
    for (const auto& attribute : tone_attributes(tone)) attributes.push_back(attribute);
    write_image(command.image, image, attributes, tone);
}

void write_report(const RenderCommand& command, const RenderReport& report) {
    if (command.needs_report()) write_report_and_page({command.report, command.page}, to_json(report));
    if (!is_quiet() && command.prints) fmt::print("{}", printable(summary_text(report)));
    if (!command.profile || !command.prints) return;
    const auto& measured = report.measured;
    fmt::print("\n{}\n", profile_table(measured.build_s, measured.builds, measured.commands));
    if (report.ranks.empty()) fmt::print("{}", roofline_table(*measured.roofline));
    for (const std::string& text : report.rank_rooflines) fmt::print("{}", text);
}

}  // namespace raya
