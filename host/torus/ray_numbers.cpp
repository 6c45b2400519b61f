#include "host/torus/ray_numbers.hpp"

#include <stdexcept>

namespace raya {
namespace {

constexpr unsigned kLightBits = 16;
constexpr std::uint64_t kLights = std::uint64_t{1} << kLightBits;

// Finaliser of SplitMix64 (Steele, Lea & Flood 2014): neighbouring pixels land far apart.
std::uint64_t scrambled(std::uint64_t x) {
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

}  // namespace

std::uint32_t RayName::place_of(std::uint32_t path, std::uint32_t level) {
    return level == 0 ? 1 : std::uint32_t{1} << level | path >> (32 - level);
}

RayName RayName::parent() const { return light != 0 ? RayName{pixel, place, 0} : RayName{pixel, place / 2, 0}; }

std::uint64_t RayNumbers::number_of(const RayName& name) {
    if (name.place == 0 || name.light >= kLights) throw std::logic_error("RayNumbers: no such ray");
    if (3 * (taken_ + 1) > 2 * slots_.size()) grow();
    Slot& slot = slot_of(std::uint64_t{name.pixel} << 32 | name.place, name.light);
    if (slot.ray == 0) {
        slot = {std::uint64_t{name.pixel} << 32 | name.place, next_++ << kLightBits | name.light};
        ++taken_;
    }
    return slot.number_and_light >> kLightBits;
}

// The slot that has the ray, or the empty one where it belongs.
RayNumbers::Slot& RayNumbers::slot_of(std::uint64_t ray, std::uint64_t light) {
    std::size_t at = scrambled(ray + scrambled(light));
    for (;; ++at) {
        Slot& slot = slots_[at & (slots_.size() - 1)];
        if (slot.ray == 0 || (slot.ray == ray && slot.number_and_light % kLights == light)) return slot;
    }
}

void RayNumbers::grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
        if (slot.ray != 0) slot_of(slot.ray, slot.number_and_light % kLights) = slot;
}

}  // namespace raya
