// Where each kernel of a render stands against what the device can do at most: the roofline (S. Williams, A. Waterman
// and D. Patterson, "Roofline: An Insightful Visual Performance Model for Multicore Architectures", 2009).
//
// An operation is one of machine/budget.hpp: an addition, a multiplication, a comparison or a multiply-add counts one,
// so do a division and a root; moves and branches count none. Operations of a kernel are its counted events times their
// budgets, so they are the same whatever the device, the number format and the compiler make of them. Bytes are those
// that a kernel has to move at least, each counted once where it is read and once where it is written.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/profile.hpp"
#include "host/model/machine.hpp"

namespace raya {

/// What all launches of a kernel's label did together.
struct KernelWork {
    std::string label;
    std::uint64_t rays = 0;        // that were traced or made
    std::uint64_t operations = 0;  // all but the next two
    std::uint64_t divisions = 0, roots = 0;
    std::uint64_t bytes = 0;  // at least
    std::uint64_t all_operations() const { return operations + divisions + roots; }
};

/// Operations of these events, by the budgets. Bytes are the caller's.
KernelWork work_of(const std::string& label, const EventCounts& events);

enum class Bound { kCompute, kBandwidth };

/// One kernel against the peak.
struct RooflineRow {
    KernelWork work;
    double seconds = 0;                 // from start to end, of all launches
    double intensity = 0;               // operations a byte
    Bound bound = Bound::kCompute;      // what the roof is at this intensity
    double share = 0;                   // of the roof: 1 is as fast as the device can be
    std::optional<double> of_format{};  // of the time that the operations take at the format's own rates; empty: none
};

struct Roofline {
    DevicePeak peak{};
    std::vector<RooflineRow> rows{};
    std::string lacking{};  // why there are none, and no peak
};

/// A row for each work whose label is a kernel's in `commands` and took time; none where the peak is not known.
Roofline roofline(const DevicePeak& peak, const std::vector<KernelWork>& works,
                  const std::vector<LabelSummary>& commands);

/// The table, then the peak, what the columns are, and for each kernel which roof it is under and what share it
/// reached.
std::string roofline_table(const Roofline& roofline);

Json peak_json(const DevicePeak& peak);
Json roofline_json(const Roofline& roofline);

}  // namespace raya
