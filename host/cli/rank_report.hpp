// What every rank of a render did and held, for the report.
#pragma once
#include <cstdint>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/profile.hpp"
#include "host/ranks/ranks.hpp"

namespace raya {

/// Of this rank.
struct RankWork {
    std::uint32_t parts = 0;  // PEs of the ring or nodes of the torus
    std::uint32_t lanes = 0, group_size = 0;
    double build_s = 0, render_s = 0;
    RankTraffic traffic{};  // while it rendered
    std::vector<LabelSummary> commands{};
};

/// One object for each rank, in rank 0; elsewhere, and where there is only one rank, none. `parts`: "pes" or "nodes".
std::vector<Json> rank_reports(Ranks& ranks, const Session& session, const char* parts, const RankWork& work);

/// ... of a machine's result.
template <class Result>
std::vector<Json> rank_reports(Ranks& ranks, const Session& session, const char* parts, const Result& r) {
    return rank_reports(ranks, session, parts,
                        RankWork{r.parts_here, r.lanes, r.group_size, r.build_s, r.render_s, r.traffic, r.commands});
}

}  // namespace raya
