#include "host/study/rank_runs.hpp"

#include <fmt/core.h>

#include "host/base/temporary_folder.hpp"

namespace raya {
namespace {

// What ranks have written or printed; RAYA_MPIRUN may name another program.
template <class Read>
auto read_as(const std::string& text, const char* what, Read&& read) try {
    return read_json(text, {what}, read);
} catch (const UserError& error) {
    throw RanksFailure(error.what());
}

std::string report_text(const std::string& file) try {
    return json_text(file, {file, "let TMPDIR name a folder that the host of rank 0 has too"});
} catch (const UserError& error) {
    throw RanksFailure(error.what());
}

}  // namespace

double RankedRender::device_s() const {
    double sum = 0;
    for (const RankedCommand& command : commands) sum += command.seconds;
    return sum;
}

double RankedRender::device_s(const std::string& label) const {
    double sum = 0;
    for (const RankedCommand& command : commands) sum += command.label == label ? command.seconds : 0;
    return sum;
}

RankedRender ranked_render(const Json& report) {
    const Json &image = report.at("image"), &device = report.at("device"), &measured = report.at("measured"),
               &rays = report.at("rays");
    RankedRender render{.render_s = measured.at("render_s").number(),
                        .hash = image.at("hash").text(),
                        .device = device.at("name").text(),
                        .platform = device.at("platform").text(),
                        .width = static_cast<std::uint32_t>(image.at("width").whole(UINT32_MAX)),
                        .height = static_cast<std::uint32_t>(image.at("height").whole(UINT32_MAX)),
                        .work = report.at("load").at("mean").number() * report.at("machine").at("pes").number(),
                        .commands = {}};
    for (const char* kind : {"primary", "reflected", "refracted", "shadow"}) render.rays += rays.at(kind).whole();
    for (const Json& command : measured.at("commands").elements())
        render.commands.push_back({command.at("label").text(), command.at("kind").text(),
                                   1e-9 * command.at("total_ns").number(), command.at("launches").whole()});
    return render;
}

RankedRender render_on_ranks(const Mpirun& mpirun, std::uint32_t ranks, std::optional<std::uint32_t> threads,
                             const std::vector<std::string>& arguments) {
    const TemporaryFolder folder("raya-ranks");
    const std::string report = folder / "report.json";
    std::vector<std::string> all = {"render"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--quiet", "-o", (folder / "image.pfm").string(), "--report", report});
    mpirun.run(ranks, threads, all);
    return read_as(report_text(report), "the ranks' report of raya render", ranked_render);
}

PingReport ping_of(const Mpirun& mpirun, std::uint32_t ranks, std::optional<std::uint32_t> threads) {
    return read_as(mpirun.run(ranks, threads, {"ping"}), "the ranks' report of raya ping", PingReport::of);
}

}  // namespace raya
