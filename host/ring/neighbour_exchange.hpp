// Neighbour pixels for every PE: moves over ring or bus that bring the blocks in which they lie.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <vector>

#include "host/ring/bus_and_ring.hpp"
#include "host/ring/route.hpp"

namespace raya {

/// A block that has arrived in every PE.
struct Arrival {
    Buffer<float>& blocks;   // [PE][3][band]
    raya_u32 side;           // on which some PE finds neighbours in it, RAYA_LEFT..RAYA_BELOW
    std::uint32_t distance;  // PE i holds words of PE (i + distance) mod P
    std::uint32_t begin;     // number in that PE's share of the block's first pixel
};

/// What moves are bands of each PE's pixels, `band` pixels long: the whole share where the PE's memory has room for a
/// second one (see PeMemory), else a part of it, and then all parts in turn.
class NeighbourExchange {
  public:
    /// `capacity`: pixels in each PE's memory; `band`: 1..capacity.
    NeighbourExchange(Session& session, Communication& counted, const raya_mapping& mapping, std::uint32_t capacity,
                      std::uint32_t band, ExchangeWay way = ExchangeWay::kRing, Ranks& ranks = Ranks::alone());

    std::uint32_t band() const { return band_; }

    /// Brings the pixels of all PEs, `own` as [PE][3][capacity] of those of this rank, to the PEs whose neighbours on
    /// `sides` they are, and calls `arrived` for each block in which some PE finds some. Of several sides none is
    /// first: whoever needs an order asks for them one by one.
    void visit(const Buffer<float>& own, std::initializer_list<raya_u32> sides,
               const std::function<void(const Arrival&)>& arrived);

  private:
    using Arrived = std::function<void(const Arrival&)>;

    void turn(const Buffer<float>& own, raya_u32 side, std::uint32_t begin, const Arrived& arrived);
    void fetch(const Buffer<float>& own, raya_u32 side, std::uint32_t begin, const Arrived& arrived);
    void hear(const Buffer<float>& own, std::initializer_list<raya_u32> sides, std::uint32_t begin,
              const Arrived& arrived);
    std::size_t pixels_from(std::uint32_t begin) const;

    std::uint32_t pes_, capacity_, band_;
    ExchangeWay way_;
    std::array<std::vector<std::uint32_t>, RAYA_SIDES> distances_;
    Ring ring_;
    Bus bus_;
    std::optional<Buffer<float>> heard_;  // [PE][3][band], of broadcasts of all PEs; a PE needs one block, as it takes
                                          // what it needs of each while it passes
};

}  // namespace raya
