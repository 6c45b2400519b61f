// Roofline model of each kernel of a render (S. Williams, A. Waterman and D. Patterson, "Roofline: An Insightful Visual
// Performance Model for Multicore Architectures", 2009).
//
// Operations are defined in host/model/budget.hpp: an addition, multiplication, comparison, multiply-add, division or
// square root counts as one; moves and branches do not count. The number of operations of a kernel is the sum of the
// budgets of all its counted events. It does not depend on device, number format or compiler. Bytes are the minimum
// that a kernel must read plus the minimum that it must write.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/profile.hpp"
#include "host/model/machine.hpp"

namespace raya {

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

/// The lower of a kernel's two roofs.
enum class Bound { kCompute, kBandwidth };

/// One kernel's rate compared with the device's peak.
struct RooflineRow {
    KernelWork work;
    double seconds = 0;                       // total time of all launches, from start to end of each
    double intensity = 0;                     // operations per byte
    Bound bound = Bound::kCompute;            // the lower roof at this intensity
    double roof_fraction = 0;                 // achieved rate divided by the roof; 1: as fast as the device's peak
    std::optional<double> format_fraction{};  // time at the format's peak rates divided by `seconds`; empty: unknown
    std::optional<HostCounts> host_counts{};  // events of the host's processor in all launches; empty: not requested
};

/// Limit of DevicePeak::scatter, above which the peak is unreliable.
inline constexpr double kMaxScatter = 0.15;

struct Roofline {
    DevicePeak peak{};
    std::vector<RooflineRow> rows{};
    std::string unavailable{};              // reason why there is no roofline; empty: there is one
    std::string host_counts_unavailable{};  // reason why RooflineRow::host_counts lacks events; empty: it lacks none
};

/// Returns a row for each kernel of `works` that `commands` contains with a time > 0; no rows if the peak is unknown.
Roofline roofline(const DevicePeak& peak, const std::vector<KernelWork>& works,
                  const std::vector<LabelSummary>& commands);

/// Returns the table, the peak, for each kernel its bound and fraction of the roof, and with `legend` the meaning of
/// the columns; then the table of host_counts, if the rows have them.
std::string roofline_table(const Roofline& roofline, bool legend = true);

Json peak_json(const DevicePeak& peak);
Json roofline_json(const Roofline& roofline);

/// Adds the members `peak` and `roofline`, or `no_roofline` with the reason, to an object of a report.
void add_to(Json& json, const Roofline& roofline);

}  // namespace raya
