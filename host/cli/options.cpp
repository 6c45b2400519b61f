#include "host/cli/options.hpp"

#include <fmt/core.h>

#include "host/error.hpp"

namespace raya {

void refuse_value(const std::string& option, const std::string& value, const char* reason, const std::string& help) {
    throw UserError(value.empty() ? fmt::format("{} {}; {}: {}", option, reason, option, help)
                                  : fmt::format("{} {}: {}; {}: {}", option, value, reason, option, help));
}

}  // namespace raya
