// Report of one render: a struct, written as JSON and as a summary on the terminal.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/profile.hpp"
#include "host/model/machine.hpp"
#include "host/model/t805.hpp"
#include "host/report/roofline.hpp"
#include "host/scene/nff.hpp"

namespace raya {

/// The part of a report that depends on the machine.
struct MachineReport {
    Json json = Json::object();  // members of the report
    std::string title{};         // in the summary's first line; empty: PEs and mapping
    std::string lines{};         // of the summary
    std::string memory{};        // in the summary's line about memory
};

/// Time on the host for building one OpenCL program.
struct ProgramBuild {
    std::string name;
    double seconds = 0;
};

struct RenderReport {
    std::string raya;  // version of raya
    std::string scene;
    std::vector<std::string> warnings;  // the warnings on stderr
    std::vector<SceneRemark> skipped;   // entities of the scene file that were skipped

    Json view;  // camera and lights after applying command-line options (view_json() in scene_report.hpp)

    struct {
        int width = 0, height = 0;         // pixels
        std::string file, hash;            // hash: of the linear pixel values
        std::optional<double> exposure{};  // stops; empty: the file has linear colours
        struct {
            int width = 0, height = 0;  // pixels
            std::string png;            // contents of the PNG file; empty: no preview
        } preview{};                    // shown in the report's page (host/image/plain_png.hpp)
    } image;

    struct {
        std::string name, topology;
        std::string mapping;              // "cyclic", "column", "rows", "blocks"; or with parameters: "grid:16x16"
        std::optional<std::string> fold;  // empty: the mapping has no slots
        std::string format;
        std::uint32_t pes = 0;
        std::optional<std::uint32_t> offset;  // p; empty: the mapping has no slots
        std::uint32_t bounces = 0;
        int length_exponent = 0;            // lengths of the scene are multiplied by 2^this (host/scene/scene.hpp)
        std::uint64_t pe_memory_bytes = 0;  // 0: no limit
        std::uint64_t pe_memory_used_bytes = 0;
    } machine;

    struct {
        std::string name, platform, version, driver, build_options;
        std::uint32_t lanes = 0, group_size = 0;
        std::string tuned;  // source of lanes, group and related options: "defaults", "options", "FILE, DATE"
    } device;

    bool counted = true;  // false: only rays and their hits were counted, so loads and modelled times are missing
    EventCounts events{};
    std::optional<std::uint64_t> requests;            // number of pixel requests; empty: scheduling was static
    Load load;                                        // loads summed over all phases
    std::vector<std::pair<std::string, Load>> loads;  // name and load of each phase
    MachineReport of_machine;

    std::vector<Json> ranks;  // device, times, messages and roofline of each MPI rank; empty for one rank
    std::vector<std::string> rank_rooflines;  // with --profile or --page: roofline of each rank, as text

    double accel_s = 0;  // measured time to build the grid or BVH; 0: none
    struct {
        double build_s = 0, render_s = 0;
        std::vector<LabelSummary> commands;
        std::vector<ProgramBuild> builds{};  // `builds` and `roofline`: only with --profile or --page
        std::optional<Roofline> roofline{};
        double earlier_s = 0;  // part of render_s: earlier runs, from whose checkpoint this run resumed
    } measured;
};

/// Value of the member "kind", which identifies the report.
inline constexpr const char* kRenderReportKind = "raya render";

/// Return the number of rays, and of intersection tests, of all kinds.
std::uint64_t ray_count(const EventCounts& events);
std::uint64_t test_count(const EventCounts& events);

/// Returns the report as JSON. docs/report.md documents the members. Later versions may add members, but do not remove
/// or change them.
Json to_json(const RenderReport& report);

/// Returns a line of the summary about loads.
std::string load_line(const std::string& label, const Load& load, const std::string& remark = {});

/// Returns the summary for the terminal: rays, load imbalance u, efficiency, times.
std::string summary_text(const RenderReport& report);

}  // namespace raya
