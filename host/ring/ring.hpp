// The ring: every PE hands a block of words to its neighbour, all at once, as counted, labelled buffer copies.
#pragma once
#include <cstddef>
#include <cstdint>

#include "host/cl/commands.hpp"
#include "host/machine/communication.hpp"
#include "host/ring/route.hpp"

namespace raya {

/// One block in the memory of each PE, and the turns that move them. The device needs a second buffer, as a copy cannot
/// overlap itself; a PE of the machine sends and receives word by word and needs one.
class Ring {
  public:
    /// `pes` blocks of `block_words` words each, both > 0; what they hold at first is undefined.
    Ring(Session& session, Communication& counted, std::size_t pes, std::size_t block_words);

    /// Copies words `begin` and on of each PE's own memory, [PE][own_words], into its block: as many as fit or exist.
    /// No transfer between PEs, so it is not counted.
    void load(const Buffer<float>& own, std::size_t own_words, std::size_t begin);

    /// One rotation of all blocks, wrap-around included.
    void rotate(Turn turn);

    /// No transfer of the ring's: PE i takes the block of PE (i + distance) mod P out of `heard`, [PE][block_words],
    /// which all PEs have heard over the bus.
    void take(const Buffer<float>& heard, std::size_t distance) { shift("ring.take", heard, front_, distance); }

    /// The block that each PE holds now, [PE][block_words].
    Buffer<float>& blocks() { return front_; }

  private:
    /// The one way in which blocks of all PEs move: PE i of `to` gets the block of PE (i + distance) mod P of `from`.
    void shift(const char* label, const Buffer<float>& from, Buffer<float>& to, std::size_t distance);

    Session& session_;
    Communication& counted_;
    std::size_t pes_, block_words_;
    Buffer<float> front_, back_;
};

}  // namespace raya
