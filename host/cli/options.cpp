#include "host/cli/options.hpp"

namespace raya {

std::string odd_value(const std::string& value, bool is_whole) {
    if (value.empty()) return "must not be empty";
    const bool digits = value.find_first_not_of("0123456789") == std::string::npos;
    return is_whole && !digits ? "'" + value + "' is not a whole number" : "";
}

}  // namespace raya
