// Bus and ring of the machine (Kohata & Ito 1993, section on the array).
// Buffer transfers with labels model the transfers of bus and ring; raya counts them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/array/render.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/model/t805.hpp"
#include "host/ring/mapping.hpp"
#include "kernels/shared/neighbours.h"

namespace raya {

/// Part of one PE's data in a buffer with the layout [PE][rows][pitch]: the words of each row from `offset` on.
/// `pitch` and `offset` are in words.
struct PeWords {
    std::size_t pe = 0, pitch = 0, offset = 0, rows = 1;
};

/// The bus between host and PEs. PE numbers are those of the whole ring. All ranks must make the same calls. Each rank
/// counts all transfers, but its buffers hold only its own PEs.
class Bus {
  public:
    Bus(Session& session, Communication& communication, Distribution pes)
        : session_(session), communication_(communication), pes_(std::move(pes)) {}

    /// Sends words from the host to all PEs, by writing them to the device buffer `target`. The PEs copy the words
    /// into their memories at the start of a kernel.
    void broadcast(Buffer<std::uint32_t>& target, std::span<const std::uint32_t> words);

    /// Sends `words` words of each row from one PE (`source`, in `pe_memory`) to another (`target`, in `blocks`). The
    /// buffers must be different, and source.rows must equal target.rows.
    void send(const Buffer<float>& pe_memory, PeWords source, Buffer<float>& blocks, PeWords target, std::size_t words);

    /// Broadcasts `words` words of each row of one PE to all other PEs. Each device has one buffer `all_blocks`, with
    /// space for the words of every PE of the ring.
    void broadcast_from(const Buffer<float>& pe_memory, PeWords source, Buffer<float>& all_blocks, PeWords target,
                        std::size_t words);

    /// Counts one gather. Several calls of gather() may read its data.
    void begin_gather() { communication_.gathers += 1; }

    /// Reads the blocks of this rank's PEs into `target`, and counts `words` words: those of the pixels in the blocks
    /// of all ranks, without padding.
    void gather(const Buffer<float>& blocks, std::span<float> target, std::uint64_t words);

  private:
    /// Transfer [row][words] to and from the host.
    std::vector<float> read(const char* label, const Buffer<float>& pe_memory, const PeWords& source,
                            std::size_t words);
    void write(const char* label, Buffer<float>& blocks, Session::Blocks target, std::size_t rows,
               std::span<const float> words);

    Session& session_;
    Communication& communication_;
    Distribution pes_;
};

/// One block in the memory of each PE, and the rotations that move all blocks. The device needs a second buffer,
/// because source and target of a copy must not overlap. A PE of the modelled machine sends and receives word by
/// word and needs only one block.
class Ring {
  public:
    /// Allocates the blocks of this rank's PEs on the device, [PE][rows][row_words], with undefined contents. All sizes
    /// must be > 0. `communication` counts the rotations of all PEs.
    Ring(Session& session, Communication& communication, Distribution pes, std::size_t rows, std::size_t row_words);

    /// Fills each PE's block from its own memory `pe_memory`, [PE][rows][memory_row_words]: copies the words of each
    /// row from `begin` on, at most row_words of them. `communication` excludes it: no data leaves a PE.
    void load(const Buffer<float>& pe_memory, std::size_t memory_row_words, std::size_t begin);

    /// Every PE sends its block to the next PE in the direction, with wrap-around at the end of the ring.
    void rotate(RingDirection direction);

    /// For each PE i, copies the block of PE (i + distance) mod P from `all_blocks` into the block of PE i.
    /// `all_blocks`: blocks that Bus::broadcast_from() has sent and counted, [PE of all ranks][rows][row_words].
    void take(const Buffer<float>& all_blocks, std::size_t distance);

    /// Current blocks of this rank's PEs, [PE][rows][row_words].
    Buffer<float>& blocks() { return front_; }

  private:
    void send_block(bool down);
    /// Copies `blocks` blocks. `first_source`, `first_target`: indices of the first block in each buffer.
    void move(const char* label, const Buffer<float>& source, std::size_t first_source, Buffer<float>& target,
              std::size_t first_target, std::size_t blocks);

    Session& session_;
    Communication& communication_;
    Distribution pes_;  // consecutive
    std::size_t rows_, row_words_, block_words_;
    Buffer<float> front_, back_;              // current blocks; target of a rotation
    std::vector<float> outgoing_, incoming_;  // block to send to another rank; block received from another rank
};

// Exchange of neighbouring pixels between PEs, over ring or bus. Every PE receives the blocks of the PEs that own
// neighbours of its pixels.

/// Blocks that have arrived, one in every PE.
struct Arrival {
    Buffer<float>& blocks;       // [PE][3][band]
    raya_u32 side = RAYA_LEFT;   // side of the neighbours that the blocks contain: RAYA_LEFT..RAYA_BELOW
    std::uint32_t distance = 0;  // PE i has received the block of PE (i + distance) mod P
    std::uint32_t begin = 0;     // index of the block's first pixel in the share of PE (i + distance) mod P
    std::uint32_t band = 0;      // number of pixels in a block
    std::uint32_t capacity = 0;  // number of pixels in each PE's memory
};

/// Exchanges neighbouring pixels. Each move carries a band: at most `band` pixels of each PE. If a PE's memory can hold
/// a second share (see PeMemory), the band is the whole share; otherwise the bands of the share are moved one after
/// another.
class NeighbourExchange {
  public:
    /// `capacity`: number of pixels in each PE's memory; `band`: number of pixels in a band, 1..capacity.
    NeighbourExchange(Session& session, Communication& communication, const raya_mapping& mapping,
                      std::uint32_t capacity, std::uint32_t band, ExchangeMethod method, const Distribution& pes);

    const Distribution& pes() const { return pes_; }
    std::uint32_t capacity() const { return capacity_; }

    /// Moves every pixel to the PEs that need it as a neighbour on one of `sides`, and calls `on_arrival` after each
    /// arrival of blocks that contain such neighbours. `pixels`: pixels of this rank's PEs, [PE][3][capacity]. The
    /// order of the sides is unspecified.
    void visit(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides,
               const std::function<void(const Arrival&)>& on_arrival);

  private:
    void rotate_band(const Buffer<float>& pixels, raya_u32 side, std::uint32_t begin,
                     const std::function<void(std::uint32_t)>& arrive);
    void broadcast_band(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides, std::uint32_t begin);
    void fetch_blocks(const Buffer<float>& pixels, std::uint32_t distance, std::uint32_t begin);
    std::size_t band_pixels(std::uint32_t begin) const;

    Distribution pes_;
    std::uint32_t capacity_, band_;
    ExchangeMethod method_;
    std::array<std::vector<std::uint32_t>, RAYA_SIDES> distances_;
    Ring ring_;
    Bus bus_;
    std::optional<Buffer<float>> broadcast_blocks_;  // [PE][3][band]; a modelled PE stores only one of the blocks
};

// The parts of anti-aliasing that need neighbouring pixels: the 3 x 3 filter (kernels/ring/filter.cl), and the
// detection of pixels that differ from a neighbour (kernels/ring/contrast.cl).

/// What both parts have in common. The kernels must be built for one lane. The constructors of the parts allocate the
/// device memory, and launch each kernel once without pixels, because PoCL compiles a kernel at its first launch.
class NeighbourPass {
  protected:
    /// `broadcast`: the job's words.
    NeighbourPass(Kernels& kernels, NeighbourExchange exchange, Buffer<std::uint32_t> broadcast)
        : session_(kernels.session()),
          group_size_(kernels.options().group_size),
          exchange_(std::move(exchange)),
          broadcast_(std::move(broadcast)) {}

    /// Launches a kernel on blocks that have arrived. `last`: the kernel's last arguments.
    template <class Kernel, class... Last>
    void launch(const std::string& label, Kernel& kernel, const Arrival& a, Last&&... last) {
        session_.launch(label, kernel, exchange_.pes().count(), group_size_, broadcast_, Uint<"side">{a.side},
                        Uint<"distance">{a.distance}, Uint<"begin">{a.begin}, Uint<"band">{a.band},
                        Uint<"capacity">{a.capacity}, Uint<"first_pe">{exchange_.pes().first()}, last...);
    }

    Session& session_;
    std::uint32_t group_size_;
    NeighbourExchange exchange_;
    Buffer<std::uint32_t> broadcast_;
};

using AddNeighboursKernel = DescribedKernel<"ring/filter.cl", "add_neighbours", const Buffer<std::uint32_t>&,
                                            Uint<"side">, Uint<"distance">, Uint<"begin">, Uint<"band">,
                                            Uint<"capacity">, Uint<"first_pe">, const Buffer<float>&, Buffer<float>&>;
using TakeMeansKernel = DescribedKernel<"ring/filter.cl", "take_means", const Buffer<std::uint32_t>&, Uint<"capacity">,
                                        Uint<"first_pe">, Buffer<float>&>;

class RingFilter : NeighbourPass {
  public:
    RingFilter(Kernels& kernels, NeighbourExchange exchange, const Buffer<std::uint32_t>& broadcast);

    /// Replaces every pixel by the mean of its 3 x 3 neighbourhood. `pixels`: [PE][3][capacity]; afterwards `pixels`
    /// refers to another buffer of the same size.
    void apply(Buffer<float>& pixels);

  private:
    void sum_two_sides(Buffer<float>& pixels, const std::string& label, raya_u32 first_side, raya_u32 second_side);
    void take_means(const std::string& label, std::uint32_t capacity, Buffer<float>& sums);

    AddNeighboursKernel add_neighbours_;
    TakeMeansKernel take_means_;
    Buffer<float> sums_;  // [PE][3][capacity]
};

using MarkContrastsKernel =
    DescribedKernel<"ring/contrast.cl", "mark_contrasts", const Buffer<std::uint32_t>&, Uint<"side">, Uint<"distance">,
                    Uint<"begin">, Uint<"band">, Uint<"capacity">, Uint<"first_pe">, cl_float, const Buffer<float>&,
                    const Buffer<float>&, Buffer<std::uint8_t>&>;

class RingContrast : NeighbourPass {
  public:
    /// `threshold`, 0..1, must be representable in the number format.
    RingContrast(Kernels& kernels, NeighbourExchange exchange, const Buffer<std::uint32_t>& broadcast, float threshold);

    /// Marks each pixel that differs from a neighbour by the threshold or more. `pixels`: [PE][3][capacity].
    void apply(const Buffer<float>& pixels);

    /// [PE][capacity]: 1 for marked pixels, else 0.
    Buffer<std::uint8_t>& marks() { return marks_; }

  private:
    float threshold_;
    MarkContrastsKernel mark_contrasts_;
    Buffer<std::uint8_t> marks_;
};

// Anti-aliasing methods, which are applied to the image after the first pass (Kohata & Ito 1993).

enum class AntialiasMethod {
    kNone,
    kFilter,      // mean of the 3 x 3 neighbourhood of every pixel
    kSupersample  // mean of five samples for each pixel that differs from a neighbour
};

struct Antialias {
    AntialiasMethod method = AntialiasMethod::kNone;
    double threshold = 0.125;            // supersampling: minimum colour difference that marks a pixel, 0..1
    raya_u32 points = RAYA_POINTS_AXES;  // supersampling: added samples, RAYA_POINTS_AXES or RAYA_POINTS_DIAGONALS
    ExchangeMethod exchange = ExchangeMethod::kRing;
};

/// Returns "none", "filter" or "supersample".
std::string antialias_name(AntialiasMethod method);

/// Throws UserError if the method needs neighbours and the mapping is dynamic or random. With such a mapping the
/// neighbours of a PE's pixels are not on PEs at a few fixed distances on the ring.
void check_antialias(AntialiasMethod method, const raya_mapping& mapping, bool dynamic);

/// Returns "axes" or "diagonals". `points`: RAYA_POINTS_AXES or RAYA_POINTS_DIAGONALS.
std::string points_name(raya_u32 points);

/// Returns, for each side, the number of ring or bus moves that bring the neighbouring pixels to every PE, if each move
/// carries a PE's whole share. The filter processes the sides one by one, as its rounded sums depend on the sides'
/// order. Supersampling compares the sides in any order, so that one series of broadcasts serves all sides.
MovesOfSides smoothing_moves(const Antialias& antialias, const raya_mapping& mapping);

/// Returns the modelled cycles of the method's arithmetic on neighbours, for a PE that owns `pixels` pixels.
SmoothingCycles smoothing_cycles(AntialiasMethod method, std::uint64_t pixels);

}  // namespace raya
