// Neighbour pixels for every PE: rotations that bring the blocks in which they lie.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/ring/ring.hpp"

namespace raya {

/// A block that has arrived in every PE.
struct Arrival {
    Buffer<float>& blocks;   // [PE][band][3]
    std::uint32_t distance;  // PE i holds words of PE (i + distance) mod P
    std::uint32_t begin;     // number in that PE's share of the block's first pixel
};

/// What goes round are bands of each PE's pixels, `band` pixels long: the whole share where the PE's memory has room
/// for a second one (see PeMemory), else a part of it, and then all parts in turn.
class NeighbourExchange {
  public:
    /// `capacity`: pixels in each PE's memory; `band`: 1..capacity.
    NeighbourExchange(Session& session, Communication& counted, const raya_mapping& mapping, std::uint32_t capacity,
                      std::uint32_t band);

    std::uint32_t band() const { return band_; }

    /// Takes the pixels of all PEs, `own` as [PE][capacity][3], round the ring the shortest way that passes every PE's
    /// neighbours on `side` (RAYA_LEFT..RAYA_BELOW), and calls `arrived` for each block in which some PE finds some.
    void visit(const Buffer<float>& own, raya_u32 side, const std::function<void(const Arrival&)>& arrived);

    /// Rotations of one visit of each side, by the routes.
    std::uint64_t rotations() const;

  private:
    void travel(const Buffer<float>& own, const Leg& leg, std::uint32_t begin,
                const std::function<void(const Arrival&)>& arrived);

    std::uint32_t pes_, capacity_, band_;
    std::array<std::vector<Leg>, RAYA_SIDES> routes_;
    Ring ring_;
};

}  // namespace raya
