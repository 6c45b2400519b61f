// The ring: every PE hands a block of words to its neighbour, all at once, as counted, labelled buffer copies; where
// the ring goes on at another rank, the block of the PE at the border goes there.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/model/communication.hpp"
#include "host/ring/pe_segment.hpp"
#include "host/ring/route.hpp"

namespace raya {

/// One block in the memory of each PE, and the turns that move them. The device needs a second buffer, as a copy cannot
/// overlap itself; a PE of the machine sends and receives word by word and needs one.
class Ring {
  public:
    /// `pes` blocks of `rows` rows of `row_words` words each, all > 0, of which those of this rank's segment lie on the
    /// device; what they hold at first is undefined. `counted` is of all ranks.
    Ring(Session& session, Communication& counted, std::uint32_t pes, std::size_t rows, std::size_t row_words,
         Ranks& ranks = Ranks::alone());

    /// Copies words `begin` and on of each row of each PE's own memory, [PE][rows][own_words], into its block: as many
    /// as fit or exist. No transfer between PEs, so it is not counted.
    void load(const Buffer<float>& own, std::size_t own_words, std::size_t begin);

    /// One rotation of all blocks, wrap-around included.
    void rotate(Turn turn);

    /// No transfer of the ring's: PE i takes the block of PE (i + distance) mod P out of `heard`,
    /// [PE][rows][row_words], which all PEs have heard over the bus: those of all ranks.
    void take(const Buffer<float>& heard, std::size_t distance);

    /// The block that each PE of the segment holds now, [PE][rows][row_words].
    Buffer<float>& blocks() { return front_; }

  private:
    void turn_here(Turn turn);
    void leave(Turn turn);
    void arrive(Turn turn);
    /// Copies blocks, numbers in blocks.
    void move(const char* label, const Buffer<float>& from, std::size_t first, Buffer<float>& to, std::size_t at,
              std::size_t blocks);

    Session& session_;
    Communication& counted_;
    Ranks& ranks_;
    PeSegment here_;
    std::size_t pes_, rows_, row_words_, block_words_;
    Buffer<float> front_, back_;
    std::vector<float> leaves_, comes_;  // a block each, on its way to another rank and from one
};

}  // namespace raya
