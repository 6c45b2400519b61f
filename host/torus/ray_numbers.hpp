// Numbers for the rays of an image, in the order in which they are asked for.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raya {

/// A ray, by its pixel and its place in the pixel's ray tree.
struct RayName {
    std::uint32_t pixel = 0;  // row W + column
    /// Of the tree's nodes the primary ray is 1, the reflected ray of node n is 2 n, the refracted one 2 n + 1: at
    /// level l a number of l + 1 bits, so that 31 bounces fit.
    std::uint32_t place = 1;
    std::uint32_t light = 0;  // of a shadow ray its light's number + 1, at most 65,535; 0 for the ray that is shaded

    /// The ray's place from the PATH of a packet and its level, 0..31 (kernels/shared/packet.h).
    static std::uint32_t place_of(std::uint32_t path, std::uint32_t level);

    /// The ray that was reflected or refracted into this one, or that this shadow ray shades. Not of a primary ray.
    RayName parent() const;
};

/// An open hash table, as there can be tens of millions: 16 bytes a slot, two thirds of them taken at most, twice as
/// many slots when there are more. So it takes 24 to 48 bytes a ray, half as much again while it grows.
class RayNumbers {
  public:
    /// The ray's number; the next one, counted from 0, for a ray that has none. std::logic_error for what is no name.
    std::uint64_t number_of(const RayName& name);

    /// A number for what will never be asked for again.
    std::uint64_t next() { return next_++; }

  private:
    struct Slot {
        std::uint64_t ray = 0;               // pixel and place; 0: empty, as no place is 0
        std::uint64_t number_and_light = 0;  // 48 bits, 16 bits
    };
    Slot& slot_of(std::uint64_t ray, std::uint64_t light);
    void grow();

    std::vector<Slot> slots_ = std::vector<Slot>(1 << 10);  // a power of 2
    std::size_t taken_ = 0;
    std::uint64_t next_ = 0;
};

}  // namespace raya
