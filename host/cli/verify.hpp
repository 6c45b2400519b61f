// The option --as of `raya verify`: a render command, parsed like that of `raya render`.
#pragma once
#include <string>
#include <vector>

#include "host/base/members.hpp"
#include "host/verify/render_case.hpp"
#include "host/verify/verify.hpp"

namespace raya {

/// The report of --report.
struct VerifyReport {
    Depth depth = Depth::kQuick;
    std::string as;  // VerifySettings::as
    std::vector<DeviceChecks> devices;
};
void members_of(Members& m, const VerifyReport& report);

/// Returns the render of such a command: reads its scene, and loads the values of raya tune unless the command has
/// --no-tuned. Throws UserError like `raya render`.
RenderCase render_case(const std::string& text);

}  // namespace raya
