#include "host/image/image.hpp"

#include <xxhash.h>

#include <bit>
#include <cstdint>
#include <memory>
#include <new>
#include <span>

#include "host/base/encoding.hpp"

namespace raya {
namespace {

/// Computes XXH3 incrementally, over 32-bit words in little-endian byte order.
class WordHash {
  public:
    WordHash() : state_(XXH3_createState(), &XXH3_freeState) {
        if (!state_) throw std::bad_alloc();
        XXH3_128bits_reset(state_.get());
    }

    void add(std::uint32_t word) {
        for (int shift = 0; shift < 32; shift += 8) bytes_.push_back(static_cast<unsigned char>(word >> shift));
        if (bytes_.size() == kBlockBytes) flush();
    }

    std::string hex() {
        flush();
        XXH128_canonical_t canonical;
        XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
        return hex_digits(canonical.digest);
    }

  private:
    static constexpr std::size_t kBlockBytes = 1 << 16;  // a multiple of 4, so that add() fills a block exactly

    void flush() {
        XXH3_128bits_update(state_.get(), bytes_.data(), bytes_.size());
        bytes_.clear();
    }

    std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
    std::vector<unsigned char> bytes_;
};

}  // namespace

std::string pixel_hash(const Image& image) {
    WordHash hash;
    hash.add(static_cast<std::uint32_t>(image.width));
    hash.add(static_cast<std::uint32_t>(image.height));
    for (const float value : image.rgb) hash.add(std::bit_cast<std::uint32_t>(value));
    return hash.hex();
}

}  // namespace raya
