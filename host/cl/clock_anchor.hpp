// How the clock of a device's event times lies against the host's.
#pragma once
#include <cstdint>

#include "host/cl/commands.hpp"

namespace raya {

/// Sends the device some tiny commands, and looks at the host's clock before and after each: the time at which a
/// command was queued lies between the two. Of the tries the one that took least is taken. Two clocks may also drift
/// apart afterwards, which is not seen. The session's profile is cleared. std::logic_error where the session does not
/// time its commands.
ClockAnchor clock_anchor(Session& session);

/// The anchor of one command, queued at `queued` by the device, given between `before` and `after` by the host.
ClockAnchor anchor_between(std::uint64_t before, std::uint64_t queued, std::uint64_t after);

}  // namespace raya
