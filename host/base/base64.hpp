// Bytes as text that may stand in an address (RFC 4648).
#pragma once
#include <string>
#include <string_view>

namespace raya {

std::string base64(std::string_view bytes);

}  // namespace raya
