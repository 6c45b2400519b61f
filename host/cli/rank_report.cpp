#include "host/cli/rank_report.hpp"

#include <fmt/core.h>

#include "host/cl/measure.hpp"
#include "host/error.hpp"
#include "host/report/profile_table.hpp"

namespace raya {
namespace {

// Measures the peak of this rank's device, and returns the roofline of the rank's kernels.
Roofline measured_roofline(RenderRun& run, const RankWork& work) {
    Roofline none;
    none.unavailable = "the counts include those of earlier runs, the times do not";
    if (work.earlier_s > 0) return none;
    run.progress.stage("measuring the device's peak");
    try {
        const DevicePeak peak = run.recorder.spans().during(
            "measure peak", [&] { return device_peak(run.device(), work.format, work.lanes); });
        if (run.ranks.is_first() && peak.scatter > kMaxScatter)
            run.input.warnings.add(
                fmt::format("three measurements of the device's peak differ by {:.0f} %: another program uses the "
                            "device; fractions of the peak are unreliable",
                            100 * peak.scatter));
        Roofline measured = roofline(peak, work.kernels, work.commands);
        if (const HostCounters* counters = run.recorder.host_counters())
            measured.host_counts_unavailable = counters->unavailable();
        return measured;
    } catch (const DeviceError& error) {  // not rethrown: the render's figures are valid without a roofline
        none.unavailable = error.what();
        return none;
    }
}

Json rank_json(const Ranks& ranks, const Session& session, const RankWork& work) {
    const DeviceInfo& device = session.device();
    return {{"rank", ranks.rank()},
            {"host", ranks.host()},
            {work.parts_member, work.parts},
            {"device",
             {{"name", device.name},
              {"platform", device.platform},
              {"version", device.version},
              {"compute_units", device.compute_units},
              {"lanes", work.lanes},
              {"group_size", work.group_size},
              {"bytes_taken", session.bytes_taken()}}},
            {"build_s", work.build_s},
            {"render_s", work.render_s},
            {"messages_sent", work.traffic.messages},
            {"bytes_sent", work.traffic.bytes},
            {"waiting_s", work.traffic.waiting_s},
            {"commands", commands_json(work.commands, true)}};
}

}  // namespace

void add_measured(RenderReport& report, const RenderCommand& command, RenderRun& run, const RankWork& work) {
    Ranks& ranks = run.ranks;
    Session& session = run.session();
    std::optional<Roofline>& roofline = report.measured.roofline;
    if (command.needs_roofline()) roofline = measured_roofline(run, work);
    report.measured.builds = run.recorder.builds();
    report.measured.earlier_s = work.earlier_s;
    run.recorder.gather(session, ranks);
    if (!ranks.has_several()) return;
    Json this_rank = rank_json(ranks, session, work);
    if (roofline) add_to(this_rank, *roofline);
    for (const std::string& text : ranks.gather(this_rank.dump()))
        report.ranks.push_back(Json::parse(text, {"the report of a rank"}));
    if (roofline)
        report.rank_rooflines =
            ranks.gather(fmt::format("rank {} on {}, {}\n{}", ranks.rank(), ranks.host(), session.device().name,
                                     roofline_table(*roofline, ranks.is_first())));
}

}  // namespace raya
