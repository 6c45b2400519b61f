#include "host/base/bytes_hash.hpp"

#include <xxhash.h>

namespace raya {

std::string hex_digits(std::span<const unsigned char> bytes) {
    std::string text;
    for (const unsigned char byte : bytes)
        for (const int digit : {byte >> 4, byte & 15}) text += "0123456789abcdef"[digit];
    return text;
}

std::string bytes_hash(std::string_view bytes) {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
    return hex_digits(canonical.digest);
}

}  // namespace raya
