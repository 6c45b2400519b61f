// Bus and ring of the machine, as counted and labelled buffer transfers (Kohata & Ito 1993, section on the array), and
// the division of PEs among ranks.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/model/time_model.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ring/route.hpp"

namespace raya {

/// Consecutive PEs of a rank. The segments of ranks differ by at most one PE.
struct PeSegment {
    std::uint32_t first = 0, count = 0;
};

/// The segment of a rank; requires pes >= ranks.
inline PeSegment segment_of(std::uint32_t pes, std::uint32_t ranks, std::uint32_t rank) {
    const auto begin = [&](std::uint64_t r) { return static_cast<std::uint32_t>(r * pes / ranks); };
    return {begin(rank), begin(rank + 1) - begin(rank)};
}

/// The rank that has a PE.
inline std::uint32_t rank_of_pe(std::uint32_t pes, std::uint32_t ranks, std::uint64_t pe) {
    return static_cast<std::uint32_t>(((pe + 1) * ranks - 1) / pes);
}

inline PeSegment own_segment(std::uint32_t pes, const Ranks& ranks) {
    return segment_of(pes, ranks.count(), ranks.rank());
}

/// Words of one PE in a buffer of `rows` rows of `pitch` words for each PE, from word `offset` of each row on.
struct PeWords {
    std::size_t pe = 0, pitch = 0, offset = 0, rows = 1;
};

/// PE numbers are those of the whole ring. All ranks must make the same transfers; each counts them all, and its
/// buffers have the PEs of its own segment.
class Bus {
  public:
    Bus(Session& session, Communication& counted, std::uint32_t pes, Ranks& ranks = Ranks::alone())
        : session_(session), counted_(counted), ranks_(ranks), pes_(pes), here_(own_segment(pes, ranks)) {}

    /// Host to all PEs. The PEs copy `to` into their memories at the start of a kernel.
    void broadcast(Buffer<std::uint32_t>& to, std::span<const std::uint32_t> words);

    /// Sends `words` words of each row from one PE to another. The buffers must differ and have the same number of
    /// rows.
    void send(const Buffer<float>& own, PeWords from, Buffer<float>& blocks, PeWords to, std::size_t words);

    /// Broadcasts `words` words of each row of one PE to all others. `heard`, once on each device, has a place for the
    /// words of every PE of the ring.
    void broadcast_from(const Buffer<float>& own, PeWords from, Buffer<float>& heard, PeWords to, std::size_t words);

    /// Counts a gather of the machine, which may take several calls of gather().
    void begin_gather() { counted_.gathers += 1; }

    /// Reads the blocks of this rank's PEs. `words`: number of words in the blocks of all ranks that are pixels, to be
    /// counted; the others are padding.
    void gather(const Buffer<float>& blocks, std::span<float> to, std::uint64_t words);

  private:
    /// Copies between buffers, and to and from the host as [row][words]. `first_of_blocks`: first PE of `blocks`.
    void copy(const char* label, const Buffer<float>& own, const PeWords& from, Buffer<float>& blocks,
              const PeWords& to, std::size_t words, std::size_t first_of_blocks);
    std::vector<float> read(const char* label, const Buffer<float>& own, const PeWords& from, std::size_t words);
    void write(const char* label, Buffer<float>& blocks, const PeWords& to, std::span<const float> words,
               std::size_t first_of_blocks);

    Session& session_;
    Communication& counted_;
    Ranks& ranks_;
    std::uint32_t pes_;
    PeSegment here_;
};

/// One block in the memory of each PE, and the rotations that move them. The device needs a second buffer, as source
/// and destination of a copy must not overlap; a PE of the machine sends and receives word by word and needs only one.
class Ring {
  public:
    /// `pes` blocks of `rows` rows of `row_words` words, all > 0; those of this rank's segment lie on the device. Their
    /// contents are undefined at first. `counted` counts the rotations of all ranks.
    Ring(Session& session, Communication& counted, std::uint32_t pes, std::size_t rows, std::size_t row_words,
         Ranks& ranks = Ranks::alone());

    /// Copies words from `begin` on of each row of each PE's own memory, [PE][rows][own_words], into its block, as many
    /// as fit or exist. Not counted, as it is no transfer between PEs.
    void load(const Buffer<float>& own, std::size_t own_words, std::size_t begin);

    /// One rotation of all blocks, including the wrap-around.
    void rotate(Turn turn);

    /// PE i takes the block of PE (i + distance) mod P from `heard`, [PE of all ranks][rows][row_words], which was
    /// broadcast over the bus. Not counted.
    void take(const Buffer<float>& heard, std::size_t distance);

    /// Current blocks of the PEs of the segment, [PE][rows][row_words].
    Buffer<float>& blocks() { return front_; }

  private:
    void turn_here(Turn turn);
    void send_block(Turn turn);
    void receive_block(Turn turn);
    /// Copies blocks; `first` and `at` count in blocks.
    void move(const char* label, const Buffer<float>& from, std::size_t first, Buffer<float>& to, std::size_t at,
              std::size_t blocks);

    Session& session_;
    Communication& counted_;
    Ranks& ranks_;
    PeSegment here_;
    std::size_t pes_, rows_, row_words_, block_words_;
    Buffer<float> front_, back_;
    std::vector<float> outgoing_, incoming_;  // a block each, to and from another rank
};

}  // namespace raya
