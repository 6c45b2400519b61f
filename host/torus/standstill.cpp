#include "host/torus/standstill.hpp"

#include <fmt/core.h>

namespace raya {

Standstill::Standstill(const StandstillFigures& stand, const std::string& remedy)
    : UserError(fmt::format("{}: the machine stands still in superstep {}: {} packets wait for each other, {} of {} "
                            "queues are full at {} packets; {}",
                            stand.scene, stand.superstep, stand.live, stand.full, stand.nodes, stand.queue, remedy)),
      figures(stand) {}

}  // namespace raya
