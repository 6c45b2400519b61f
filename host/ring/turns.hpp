// Scenes that do not fit a PE: every PE holds a part of the objects, and the parts rotate on the ring while the rays
// stay in their PEs (kernels/ring/turn.cl). Kohata & Ito 1993, section 5, name the division of the object data as
// future work.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/array/checkpoints.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/ring_plan.hpp"
#include "kernels/shared/part.h"

namespace raya {

/// A job divided into parts. PE i starts with part i mod G.
struct ObjectParts {
    std::vector<std::uint32_t> base;   // the job's header and lights, which every PE stores
    std::vector<std::uint32_t> words;  // [G][part_words]: the parts (kernels/shared/part.h), padded with zeros
    std::uint32_t parts = 1;           // G
    std::uint32_t part_words = 0;      // number of words of the largest part, a multiple of four

    std::span<const std::uint32_t> part(std::uint32_t i) const {
        return std::span(words).subspan(std::size_t{i} * part_words, part_words);
    }
};

/// Divides the objects of a job without accelerator into `parts` parts of consecutive object numbers, whose numbers of
/// objects differ by at most one. A part may be empty.
ObjectParts divide_objects(const PackedJob& job, std::uint32_t parts);

/// What every PE stores of a scene, and the plan of its memory.
struct StoredScene {
    std::optional<ObjectParts> parts;  // if the objects are divided
    PeMemory memory;

    /// Returns the words that are broadcast to all PEs.
    const std::vector<std::uint32_t>& words(const PackedJob& job) const { return parts ? parts->base : job.words(); }
};

/// Divides the objects into settings.split parts or, if it is 0 and the scene does not fit a PE, into the smallest
/// number of parts that fit. `scene`: name, for messages. Throws DoesNotFit if that number, or no number, fits.
StoredScene store_scene(const PackedJob& job, const RingSettings& settings, const std::string& scene);

using AdvanceKernel =
    DescribedKernel<"ring/turn.cl", "advance", const Buffer<std::uint32_t>&, Uint<"word_count">, Uint<"window_start">,
                    Uint<"capacity">, Uint<"end">, Uint<"points">, Uint<"first_pe">, Uint<"slots">, Uint<"stride">,
                    Uint<"fresh">, const Buffer<std::uint8_t>&, LocalMemory<raya_trace_progress>,
                    LocalMemory<std::uint32_t>, Buffer<float>&, Buffer<std::uint64_t>&, Buffer<std::uint64_t>&,
                    Buffer<raya_trace_progress>&, Buffer<std::uint32_t>&, Buffer<std::uint64_t>&>;
using MeetKernel =
    DescribedKernel<"ring/turn.cl", "meet", const Buffer<std::uint32_t>&, Uint<"word_count">, const Buffer<float>&,
                    Uint<"part_words_count">, Uint<"slots">, Uint<"stride">, Uint<"step">, LocalMemory<std::uint32_t>,
                    Buffer<raya_trace_progress>&, Buffer<std::uint32_t>&, Buffer<std::uint64_t>&>;

/// Traces the pixels of a share in turns of the objects. A turn that no PE needs is not made.
class Turns : public SampleTracer {
  public:
    /// `slots`: number of ray trees that a PE keeps in flight. Other arguments: as of Tracer.
    Turns(Kernels& kernels, Communication& communication, const Distribution& pes, std::uint32_t capacity,
          const ObjectParts& parts, std::uint32_t slots);

    void warm_up(const TracePass& pass) override;
    /// Appends the turns to counters.turn_cycles. After visit_state() has restored trees in flight, continues them.
    void trace(const TracePass& pass, const ProgressCallback& progress) override;

    /// Sends every part to the PEs that start with it: one broadcast over the bus for each part.
    void broadcast_parts();

    /// Sets a function that trace() calls after each turn, with the completed fraction of its range.
    void after_turn(ProgressCallback function) { after_turn_ = std::move(function); }

    /// Saves or restores the trees in flight. `turns`: number of turns of the render so far.
    void visit_state(RenderState& state, std::uint64_t turns);

  private:
    /// Sets the next pixel of every PE, without trees in flight.
    void start(const TracePass& pass);
    /// Gives every PE the part that it holds after `rotations` rotations.
    void load_parts(std::uint64_t rotations);
    void advance(const TracePass& pass, bool fresh);
    void meet(const TracePass& pass, std::uint32_t step);
    /// Returns the sum of the cycles of the busiest PE in each of `steps` steps.
    std::uint64_t barrier_cycles(const std::string& label, std::uint32_t steps);
    LocalMemory<std::uint32_t> local_words(std::size_t words) const { return {options_.words_local ? words : 4}; }

    const ObjectParts& parts_;
    Communication& communication_;
    std::uint32_t slots_, stride_;
    Ring ring_;
    AdvanceKernel advance_;
    MeetKernel meet_;
    Buffer<std::uint32_t> state_;  // [PE][word][stride]: ray trees in flight (kernels/ring/flight.clh)
    Buffer<std::uint64_t> spent_;  // [G + 1][PE][L]: modelled cycles of each step of a turn
    bool in_flight_ = false;       // state_ is restored
    ProgressCallback after_turn_;
};

}  // namespace raya
