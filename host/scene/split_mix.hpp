// Platform-independent random numbers.
#pragma once
#include <cstdint>

namespace raya {

/// The generator SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, "Fast Splittable Pseudorandom Number Generators",
/// OOPSLA 2014).
class SplitMix {
  public:
    explicit SplitMix(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }

    /// Returns a uniformly distributed number in [lowest, highest), made of the upper 53 bits of next().
    double uniform(double lowest, double highest) {
        return lowest + (highest - lowest) * (static_cast<double>(next() >> 11) * 0x1p-53);
    }

  private:
    std::uint64_t state_;
};

}  // namespace raya
