// The bus and the ring, as counted, labelled buffer transfers (Kohata & Ito 1993, section on the array), and which
// PEs each rank has.
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

/// PEs of a rank: consecutive ones, as many as the others have, or one more.
struct PeSegment {
    std::uint32_t first = 0, count = 0;
};

/// Those of a rank, of `pes` >= `ranks` in all.
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

/// Where words of one PE lie in a buffer that holds `rows` rows of `pitch` words of each: from word `offset` of each of
/// its rows on.
struct PeWords {
    std::size_t pe = 0, pitch = 0, offset = 0, rows = 1;
};

/// PEs are numbers of the whole ring. Of several ranks all make the same transfers, `counted` is of all of them, and a
/// buffer has the PEs of the rank's own segment.
class Bus {
  public:
    Bus(Session& session, Communication& counted, std::uint32_t pes, Ranks& ranks = Ranks::alone())
        : session_(session), counted_(counted), ranks_(ranks), pes_(pes), here_(own_segment(pes, ranks)) {}

    /// The same words to every PE. `to` is what all PEs take into their memories when they start.
    void broadcast(Buffer<std::uint32_t>& to, std::span<const std::uint32_t> words);

    /// `words` of each row of one PE to another, between buffers that are not the same and have as many rows.
    void send(const Buffer<float>& own, PeWords from, Buffer<float>& blocks, PeWords to, std::size_t words);

    /// `words` of each row of one PE to every other. `heard` is what all PEs listen to: it lies on each device once,
    /// the words of every PE of the ring that spoke in its place.
    void broadcast_from(const Buffer<float>& own, PeWords from, Buffer<float>& heard, PeWords to, std::size_t words);

    /// All PEs hand over what their memories hold: one gather of the machine, in one part or more.
    void begin_gather() { counted_.gathers += 1; }

    /// A part of the blocks of all PEs to the host; to that of their rank, where there are several. `words` of it are
    /// pixels, those of all PEs; the rest is empty.
    void gather(const Buffer<float>& blocks, std::span<float> to, std::uint64_t words);

  private:
    /// Of this rank's PEs, or of all of them: between buffers, and to and from the host, [row][words].
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
