// Report of one render: a struct, written as JSON and as a summary on the terminal.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/base/members.hpp"
#include "host/cl/device.hpp"
#include "host/cl/profile.hpp"
#include "host/model/budget.hpp"
#include "host/model/machine.hpp"
#include "host/model/t805.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace raya {

// Roofline model of each kernel of a render (S. Williams, A. Waterman and D. Patterson, "Roofline: An Insightful Visual
// Performance Model for Multicore Architectures", 2009).
//
// Operations are defined in host/model/budget.hpp: an addition, multiplication, comparison, multiply-add, division or
// square root counts as one; moves and branches do not count. The number of operations of a kernel is the sum of the
// budgets of all its counted events. It does not depend on device, number format or compiler. Bytes are the minimum
// that a kernel must read plus the minimum that it must write.

/// Total work of all launches of a kernel. The launches have the same label.
struct KernelWork {
    std::string label;
    std::uint64_t rays = 0;                  // number of rays traced or generated
    std::uint64_t operations = 0;            // number of operations except divisions and square roots
    std::uint64_t divisions = 0, roots = 0;  // roots: square roots
    std::uint64_t bytes = 0;                 // minimum number of bytes that the kernel must read and write
    std::uint64_t all_operations() const { return operations + divisions + roots; }
};

/// Returns the rays and operations of these events. The caller must set `bytes`.
KernelWork work_of(const std::string& label, const EventCounts& events);

/// One kernel's rate compared with the device's peak.
struct RooflineRow {
    KernelWork work;
    double seconds = 0;                       // total time of all launches, from start to end of each
    double intensity = 0;                     // operations per byte
    const char* bound = "compute";            // the lower roof at this intensity: "compute" or "bandwidth"
    double roof_fraction = 0;                 // achieved rate divided by the roof; 1: as fast as the device's peak
    std::optional<double> format_fraction{};  // time at the format's peak rates divided by `seconds`; empty: unknown
};

/// Limit of DevicePeak::scatter, above which the peak is unreliable.
inline constexpr double kMaxScatter = 0.15;

struct Roofline {
    DevicePeak peak{};
    std::vector<RooflineRow> rows{};
    std::string unavailable{};  // reason why there is no roofline; empty: there is one
};

/// Returns a row for each kernel of `works` that `commands` contains with a time > 0; no rows if the peak is unknown.
Roofline roofline(const DevicePeak& peak, const std::vector<KernelWork>& works,
                  const std::vector<LabelSummary>& commands);

/// Returns the table and the peak as text.
std::string roofline_table(const Roofline& roofline);

void members_of(Members& m, const RooflineRow& row);

/// Adds the members `peak` and `roofline`, or `no_roofline` with the reason; none of them if `roofline` is empty.
void roofline_members(Members& m, const std::optional<Roofline>& roofline);

/// The part of a report that depends on the machine.
struct MachineReport {
    Json json = Json::object();  // the members, for Members::include()
    std::string title{};         // in the summary's first line; empty: PEs and mapping
    std::string lines{};         // of the summary
    std::string memory{};        // in the summary's line about memory
};

/// Time on the host for building one OpenCL program.
struct ProgramBuild {
    std::string name;
    double seconds = 0;
};

/// One MPI rank of a render.
struct RankReport {
    std::uint32_t rank = 0;
    std::string host;
    bool torus = false;
    std::uint32_t parts = 0;  // number of its PEs or nodes
    DeviceInfo device;
    std::uint32_t lanes = 0, group_size = 0;
    std::uint64_t bytes_taken = 0;  // size of all buffers created on the device
    double build_s = 0, render_s = 0;
    std::uint64_t messages_sent = 0, bytes_sent = 0;
    double waiting_s = 0;  // time spent waiting for other ranks
    std::vector<LabelSummary> commands;
    std::optional<Roofline> roofline{};
};

/// Camera and lights, after command-line options have changed them.
struct SceneView {
    View camera;
    Colour background;
    std::vector<Light> lights;  // with their emitted colours
};
SceneView view_of(const Scene& scene);

struct RenderReport {
    std::string raya;  // version of raya
    std::string scene;
    std::vector<std::string> warnings;  // the warnings on stderr
    std::vector<SceneRemark> skipped;   // entities of the scene file that were skipped

    SceneView view;

    struct {
        int width = 0, height = 0;         // pixels
        std::string file, hash;            // hash: of the linear pixel values
        std::optional<double> exposure{};  // stops; empty: the file has linear colours
        struct {
            int width = 0, height = 0;  // pixels
            std::string png;            // contents of the PNG file; empty: no preview
        } preview{};                    // shown in the report's page (host/image/image_io.hpp)
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

    std::vector<Written<RankReport>> ranks;   // empty for one rank
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

// Lists of the members of reports, for to_json() and schema_of(). Later versions may add members, but do not remove or
// change them.

void members_of(Members& m, const LabelSummary& commands);
void members_of(Members& m, const RankReport& rank);
void members_of(Members& m, const SceneView& view);
void members_of(Members& m, const SceneRemark& remark);
void members_of(Members& m, const RenderReport& report);

// Descriptions of members that several reports have.
inline constexpr const char* kVersionMeaning = "Version of raya.";
inline constexpr const char* kSceneMeaning = "Scene file, as given on the command line.";
inline constexpr const char* kWarningsMeaning = "Warnings printed to stderr, one sentence each.";
inline constexpr const char* kSkippedMeaning =
    "Statements of the scene file that raya ignored or changed, one entry for each kind.";
inline constexpr const char* kViewMeaning =
    "Camera, lights and background. The options --from, --at, --up, --angle, --background and --light reproduce the "
    "picture from these values.";
inline constexpr const char* kHashMeaning =
    "128-bit XXH3 hash of the linear pixel values. It depends only on the pixels, not on device, lanes, PEs or "
    "mapping.";
inline constexpr const char* kFormatMeaning =
    "Number format: `fp32`, or `eXmY` with X exponent and Y fraction bits; `t` truncates. `e6m15` is spa22 "
    "(kernels/number/README.md).";
inline constexpr const char* kLanesMeaning = "Number of rays that one work-item traces at once: 1, 4, 8 or 16.";
inline constexpr const char* kGroupMeaning = "Number of work-items in the work-group of a PE.";

/// Returns a line of the summary about loads.
std::string load_line(const std::string& label, const Load& load, const std::string& remark = {});

/// Returns the summary for the terminal: rays, load imbalance u, efficiency, times.
std::string summary_text(const RenderReport& report);

}  // namespace raya
