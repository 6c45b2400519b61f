// Roofline model of each kernel of a render (S. Williams, A. Waterman and D. Patterson, "Roofline: An Insightful Visual
// Performance Model for Multicore Architectures", 2009).
//
// Operations are those of host/model/budget.hpp: an addition, multiplication, comparison, multiply-add, division or
// root counts as one; moves and branches do not count. The operations of a kernel are its counted events times their
// budgets, independent of device, number format and compiler. Bytes are the minimum that a kernel has to read plus the
// minimum that it has to write.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/profile.hpp"
#include "host/model/machine.hpp"

namespace raya {

/// Work of all launches of a kernel's label.
struct KernelWork {
    std::string label;
    std::uint64_t rays = 0;        // traced or generated
    std::uint64_t operations = 0;  // without divisions and roots
    std::uint64_t divisions = 0, roots = 0;
    std::uint64_t bytes = 0;  // minimum
    std::uint64_t all_operations() const { return operations + divisions + roots; }
};

/// Rays and operations of these events, by the budgets. The caller sets `bytes`.
KernelWork work_of(const std::string& label, const EventCounts& events);

enum class Bound { kCompute, kBandwidth };

/// One kernel compared with the device's peak.
struct RooflineRow {
    KernelWork work;
    double seconds = 0;                 // of all launches, from start to end
    double intensity = 0;               // operations per byte
    Bound bound = Bound::kCompute;      // the roof at this intensity
    double share = 0;                   // of the roof; 1: as fast as the device's peak
    std::optional<double> of_format{};  // time of the operations at the format's own rates over `seconds`; empty: none
};

struct Roofline {
    DevicePeak peak{};
    std::vector<RooflineRow> rows{};
    std::string unavailable{};  // reason, if there are no rows and no peak
};

/// Returns a row for each work whose label is a kernel in `commands` with time > 0; no rows if the peak is unknown.
Roofline roofline(const DevicePeak& peak, const std::vector<KernelWork>& works,
                  const std::vector<LabelSummary>& commands);

/// The table, the peak, the meaning of the columns, and for each kernel its bound and share of the roof.
std::string roofline_table(const Roofline& roofline);

Json peak_json(const DevicePeak& peak);
Json roofline_json(const Roofline& roofline);

}  // namespace raya
