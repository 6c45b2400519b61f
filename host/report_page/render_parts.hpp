// The parts of a render's page, as HTML.
#pragma once
#include <optional>
#include <string>

#include "host/base/json.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

/// The picture, and maps of its pixels' owners or of the torus's nodes.
std::string pictures_html(const Json& report, const std::optional<raya_mapping>& mapping);

/// The load of each PE or node as bars and a table.
std::string loads_html(const Json& report);

/// What went over the torus's links; nothing of a ring.
std::string traffic_html(const Json& report);

/// The modelled machine's time beside this device's, part by part.
std::string model_html(const Json& report);

/// Times by label.
std::string labels_html(const Json& report);

/// A drawing and a table of kernels against the peak, and what the peak is. `rows`: as roofline_json() writes them,
/// each with its name in `names`.
std::string roofline_html(const std::string& id, const Json& peak, const std::vector<const Json*>& rows,
                          const std::vector<std::string>& names);

/// The same of a render, or why there is none.
std::string render_roofline_html(const Json& report);

/// What was counted.
std::string counts_html(const Json& report);

/// Machine, device, driver, builds and their options, ranks.
std::string making_html(const Json& report);

}  // namespace raya
