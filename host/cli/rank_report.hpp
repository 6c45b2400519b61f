// Per-rank figures of a render, for the report.
#pragma once
#include <cstdint>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/profile.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

/// The work of this rank in a render.
struct RankWork {
    std::uint32_t parts = 0;  // number of PEs or nodes that this rank simulates
    std::uint32_t lanes = 0, group_size = 0;
    double build_s = 0, render_s = 0;
    RankTraffic traffic{};  // messages between ranks during the render
    std::vector<LabelSummary> commands{};
};

/// Sends every rank's `work` to rank 0. On rank 0, returns one JSON object per rank. On other ranks, and if there
/// is only one rank, returns an empty vector. `parts_member`: name of the JSON member for RankWork::parts, "pes" or
/// "nodes".
std::vector<Json> rank_reports(Ranks& ranks, const Session& session, const char* parts_member, const RankWork& work);

/// Calls rank_reports() with the figures in `r`, the result of a ring or torus render.
template <class Result>
std::vector<Json> rank_reports(Ranks& ranks, const Session& session, const char* parts_member, const Result& r) {
    return rank_reports(ranks, session, parts_member,
                        RankWork{r.parts_of_rank, r.lanes, r.group_size, r.build_s, r.render_s, r.traffic, r.commands});
}

}  // namespace raya
