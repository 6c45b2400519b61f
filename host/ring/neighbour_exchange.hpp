// Brings the blocks of pixels that contain neighbours to every PE, over ring or bus.
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
    raya_u32 side;           // of the neighbours that it contains, RAYA_LEFT..RAYA_BELOW
    std::uint32_t distance;  // PE i holds the block of PE (i + distance) mod P
    std::uint32_t begin;     // index of the block's first pixel in that PE's share
};

/// Moves bands of `band` pixels of each PE: the whole share if the PE's memory can hold a second one (see PeMemory),
/// else its parts in turn.
class NeighbourExchange {
  public:
    /// `capacity`: pixels in each PE's memory; `band`: 1..capacity.
    NeighbourExchange(Session& session, Communication& counted, const raya_mapping& mapping, std::uint32_t capacity,
                      std::uint32_t band, ExchangeMethod method = ExchangeMethod::kRing, Ranks& ranks = Ranks::alone());

    std::uint32_t band() const { return band_; }

    /// Brings pixels to the PEs whose neighbours on `sides` they are, and calls `arrived` for each block with
    /// neighbours of some PE. `own`: [PE][3][capacity], of this rank's PEs. The order of several sides is unspecified.
    void visit(const Buffer<float>& own, std::initializer_list<raya_u32> sides,
               const std::function<void(const Arrival&)>& arrived);

  private:
    using Arrived = std::function<void(const Arrival&)>;

    void exchange_by_rotation(const Buffer<float>& own, raya_u32 side, std::uint32_t begin, const Arrived& arrived);
    void exchange_by_transfers(const Buffer<float>& own, raya_u32 side, std::uint32_t begin, const Arrived& arrived);
    void exchange_by_broadcast(const Buffer<float>& own, std::initializer_list<raya_u32> sides, std::uint32_t begin,
                               const Arrived& arrived);
    std::size_t pixels_from(std::uint32_t begin) const;

    std::uint32_t pes_, capacity_, band_;
    ExchangeMethod method_;
    std::array<std::vector<std::uint32_t>, RAYA_SIDES> distances_;
    Ring ring_;
    Bus bus_;
    std::optional<Buffer<float>> broadcast_blocks_;  // [PE][3][band]; a PE of the machine needs only one block
};

}  // namespace raya
