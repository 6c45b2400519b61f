// The report of one render: plain data, as JSON for programs and as a few lines for people.
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cl/profile.hpp"
#include "machine/machine.hpp"
#include "report/communication.hpp"
#include "report/load.hpp"

namespace raya {

struct RenderReport {
    std::string scene;

    struct {
        int width = 0, height = 0;  // pixels
        std::string file, hash;     // hash of the pixel values: equal for equal pixels
    } image;

    struct {
        std::string name, topology, mapping, fold, format;
        std::uint32_t pes = 0, offset = 0, bounces = 0;
        std::uint64_t pe_memory_bytes = 0;  // 0: no limit
        std::uint64_t pe_memory_used_bytes = 0;
    } machine;

    struct {
        std::string name, platform, version, build_options;
        std::uint32_t lanes = 0, group_size = 0;
    } device;

    EventCounts events{};
    Load load;
    Communication communication;

    struct {
        double build_s = 0, render_s = 0;
        std::vector<LabelSummary> commands;
    } measured;
};

/// Rays of all kinds.
std::uint64_t ray_count(const EventCounts& events);

/// The keys are fixed; more may be added.
nlohmann::ordered_json to_json(const RenderReport& report);

/// Rays, u, efficiency and times in a few lines.
std::string human_summary(const RenderReport& report);

/// One line for each label of the measured commands: launches, total, share, min, mean, max.
std::string profile_table(const std::vector<LabelSummary>& commands);

}  // namespace raya
