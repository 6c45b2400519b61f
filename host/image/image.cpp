#include "host/image/image.hpp"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
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

namespace {

double linear_from_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace

const CodeBorders& srgb_borders() {
    static const CodeBorders borders = [] {
        CodeBorders all;
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = linear_from_srgb((static_cast<double>(k) + 0.5) / 255);
        return all;
    }();
    return borders;
}

std::uint8_t nearest_code(const CodeBorders& borders, double linear) {
    const auto border = std::lower_bound(borders.begin(), borders.end(), linear);
    return static_cast<std::uint8_t>(border - borders.begin());
}

float srgb_light(std::uint8_t code) { return static_cast<float>(linear_from_srgb(code / 255.0)); }

std::uint8_t srgb_code(float linear) { return nearest_code(srgb_borders(), static_cast<double>(linear)); }

ToneCodes::ToneCodes(double exposure) : factor_(std::exp2(exposure)) {
    for (std::size_t k = 0; k < codes_.size(); ++k)
        codes_[k] = nearest_code(srgb_borders(), static_cast<double>(k) / kCells);
}

std::array<std::uint8_t, 3> ToneCodes::operator()(const float* rgb) const {
    constexpr double kMaxFloat = std::numeric_limits<float>::max();
    const CodeBorders& borders = srgb_borders();
    std::array<std::uint8_t, 3> codes{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double linear = std::isnan(rgb[i]) ? 0 : factor_ * std::clamp<double>(rgb[i], -kMaxFloat, kMaxFloat);
        std::size_t code = codes_[static_cast<std::size_t>(std::clamp(linear, 0.0, 1.0) * kCells)];
        while (code < borders.size() && borders[code] < linear) ++code;
        codes[i] = static_cast<std::uint8_t>(code);
    }
    return codes;
}

}  // namespace raya
