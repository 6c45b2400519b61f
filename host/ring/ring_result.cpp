#include "host/ring/ring_result.hpp"

#include <stdexcept>

namespace raya {

const CostImage& Phase::cost() const {
    if (!kept_cost) throw std::logic_error("costs of pixels that were not kept: RingSettings::keep_costs");
    return *kept_cost;
}

double trace_seconds(const RingResult& result) {
    double ns = 0;
    for (const LabelSummary& command : result.commands)
        if (command.label == kTracePass || command.label == kSupersamplePass)
            ns += static_cast<double>(command.total_ns);
    return ns > 0 ? ns * 1e-9 : result.render_s;
}

}  // namespace raya
