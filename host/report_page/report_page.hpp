// Saved reports as pages. Whatever a page tells stands in the report: nothing runs again. JsonError for a report that
// lacks something, with its name; members that are not known are passed over.
#pragma once
#include <optional>
#include <string>

#include "host/base/json.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

/// Of `raya render --report`. `mapping`: who owns which pixel, where one rule says so; its PEs are the report's.
std::string render_page(const Json& report, const std::optional<raya_mapping>& mapping);

/// Of `raya bench --report`.
std::string bench_page(const Json& report);

/// Of `raya verify --report`.
std::string verify_page(const Json& report);

}  // namespace raya
