// Exchange of neighbouring pixels between PEs, over ring or bus. Every PE receives the blocks of the PEs that own
// neighbours of its pixels.
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

/// Blocks that have arrived, one in every PE.
struct Arrival {
    Buffer<float>& blocks;   // [PE][3][band]
    raya_u32 side;           // side of the neighbours that the blocks contain: RAYA_LEFT..RAYA_BELOW
    std::uint32_t distance;  // PE i has received the block of PE (i + distance) mod P
    std::uint32_t begin;     // index of the block's first pixel in the share of PE (i + distance) mod P
};

/// Exchanges neighbouring pixels. Each move carries a band: at most `band` pixels of each PE. If a PE's memory can hold
/// a second share (see PeMemory), the band is the whole share; otherwise the bands of the share are moved one after
/// another.
class NeighbourExchange {
  public:
    /// `capacity`: number of pixels in each PE's memory; `band`: number of pixels in a band, 1..capacity.
    NeighbourExchange(Session& session, Communication& communication, const raya_mapping& mapping,
                      std::uint32_t capacity, std::uint32_t band, ExchangeMethod method = ExchangeMethod::kRing,
                      Ranks& ranks = Ranks::single());

    std::uint32_t band() const { return band_; }

    /// Moves every pixel to the PEs that need it as a neighbour on one of `sides`, and calls `on_arrival` after each
    /// arrival of blocks that contain such neighbours. `pixels`: pixels of this rank's PEs, [PE][3][capacity]. The
    /// order of the sides is unspecified.
    void visit(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides,
               const std::function<void(const Arrival&)>& on_arrival);

  private:
    using ArrivalCallback = std::function<void(const Arrival&)>;

    void exchange_by_rotation(const Buffer<float>& pixels, raya_u32 side, std::uint32_t begin,
                              const ArrivalCallback& on_arrival);
    void exchange_by_transfers(const Buffer<float>& pixels, raya_u32 side, std::uint32_t begin,
                               const ArrivalCallback& on_arrival);
    void exchange_by_broadcast(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides, std::uint32_t begin,
                               const ArrivalCallback& on_arrival);
    std::size_t band_pixels(std::uint32_t begin) const;

    std::uint32_t pes_, capacity_, band_;
    ExchangeMethod method_;
    std::array<std::vector<std::uint32_t>, RAYA_SIDES> distances_;
    Ring ring_;
    Bus bus_;
    std::optional<Buffer<float>> broadcast_blocks_;  // [PE][3][band]; a modelled PE stores only one of the blocks
};

}  // namespace raya
