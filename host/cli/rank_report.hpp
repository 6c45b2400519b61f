// Measured figures of a render, for the report: the roofline, and the figures of each rank.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/cli/render_command.hpp"
#include "host/model/number_format.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/render_report.hpp"
#include "host/report/roofline.hpp"

namespace raya {

/// The work of this rank in a render.
struct RankWork {
    std::string parts_member;  // name of the JSON member for `parts`: "pes" or "nodes"
    std::uint32_t parts = 0;   // number of PEs or nodes that this rank simulates
    NumberFormat format{};
    std::uint32_t lanes = 0, group_size = 0;
    double build_s = 0, render_s = 0, earlier_s = 0;  // earlier_s: part of render_s, before a resume
    RankTraffic traffic{};                            // messages between ranks during the render
    std::vector<LabelSummary> commands{};
    std::vector<KernelWork> kernels{};
};

/// Returns the work in `r`, the result of a ring or torus render.
template <class Result>
RankWork rank_work(const std::string& parts_member, const NumberFormat& format, const Result& r,
                   const std::vector<KernelWork>& kernels) {
    return {parts_member, r.parts_of_rank, format,    r.lanes,    r.group_size, r.build_s,
            r.render_s,   r.earlier_s,     r.traffic, r.commands, kernels};
}

/// Collective: adds the figures of all ranks to rank 0's report and, for --profile and --page, the build times and the
/// rooflines. For these, all ranks measure the peaks of their devices at the same time. Also gathers the records of the
/// ranks for --trace.
void add_measured(RenderReport& report, const RenderCommand& command, RenderRun& run, const RankWork& work);

}  // namespace raya
