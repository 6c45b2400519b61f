// The machines of the study of ranks: what their renders are given, and what each number of ranks has of them.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/study/laboratory.hpp"
#include "host/study/rank_runs.hpp"
#include "host/study/ranks_model.hpp"

namespace raya {

/// One machine with its scene. The counted parts are those of `ranks`.
struct RankedMachine {
    std::string name;                    // "ring", "torus"
    std::vector<std::string> arguments;  // of raya render
    std::vector<std::uint32_t> ranks;    // 1, 2, 4, ...
    std::vector<std::string> arrays;     // on so many ranks: "512 PEs", "16x16x8 nodes, assumed"
    /// Of the i-th number of ranks.
    std::function<RankParts(std::size_t i, const MeasuredWork&, const Network&, double processors)> predict;
    std::string trace_label;  // of what the device does on rays
};

inline constexpr std::uint32_t kMostRanks = 65'536;

/// The ring with the filter: as many PEs as the image has columns, or as ranks where these are more; loads are sums of
/// pixels' costs. `file`: where the scene lies.
RankedMachine ring_on_ranks(Laboratory& lab, const LabelledScene& scene, const std::string& file, std::uint32_t size);

/// A torus of 8 x 8 x 8 nodes, counted in one render; beyond as many ranks, tori whose nodes have been cut further.
RankedMachine torus_on_ranks(Session& session, const LabelledScene& scene, const std::string& file, std::uint32_t size);

/// What one rank took.
MeasuredWork work_of(const RankedMachine& machine, const RankedRender& one);

}  // namespace raya
