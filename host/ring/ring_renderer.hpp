// Renders a scene on a model of a ring machine: the host drives PEs, bus and ring; the kernels are the PEs.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/base/clock.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/neighbour_exchange.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/ring_result.hpp"
#include "host/ring/ring_state.hpp"
#include "host/ring/smoothing.hpp"
#include "host/ring/tracer.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"

namespace raya {

class RingRenderer {
  public:
    /// Packs the scene, checks that it fits the machine's PEs, builds the kernels and takes the device memory for the
    /// PEs of this rank. Only rank 0 looks at the scene. Throws UserError (what does not fit, what is out of range,
    /// more ranks than PEs), DeviceError.
    RingRenderer(Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks = Ranks::alone());

    /// One image. May be called again: the pixels are the same, the times are those of this call. In other ranks than 0
    /// the result is of this rank alone, and has no image.
    /// `keeping`, where given, is of one rank, and the image is traced in bands, after each of which what is done may
    /// be kept; a render that goes on makes the same image and counts the same, and its seconds are those of all runs.
    RingResult render(const ProgressCallback& progress = {}, const RingKeeping* keeping = nullptr);

    /// By what the scene's lengths are multiplied.
    const LengthScale& scale() const { return job_.scale; }

  private:
    bool keeps_costs() const { return settings_.keep_costs || settings_.dynamic.has_value(); }
    bool listens() const { return ranks_.many() && ranks_.first(); }  // for what others tell of their failures
    void build();
    void build_exchange(KernelOptions options);
    void prepare(RingResult& result);
    void render_block(std::uint32_t block, RingResult& result, const ProgressCallback& progress);
    void trace(PixelRange range, RingResult& result, const ProgressCallback& progress);
    void supersample(RingResult& result, const ProgressCallback& progress);
    void in_bands(std::uint32_t pass, PixelRange range, RingResult& result,
                  const std::function<void(PixelRange)>& trace);
    StateSettings state_settings() const;
    RingState host_state(const RingResult& result) const;
    RingState state(const RingResult& result);
    void resume(RingResult& result);
    void keep(std::uint32_t pass, PixelRange range, RingResult& result);
    void make_room(RingResult& result);
    void gather(PixelRange range, RingResult& result);
    void place_gathered(RingResult& result);
    void place(const PeSegment& pes, PixelRange range, std::span<const float> pixels, RingResult& result) const;
    template <class T, class Take>
    void bring(std::vector<T>& own, std::size_t of_pe, const Take& take);
    void collect_costs(PixelRange range, RingResult& result);
    void collect_marks(RingResult& result);
    void collect_events(RingResult& result);
    void simulate_schedule(RingResult& result);
    void describe(RingResult& result);

    Session& session_;
    Ranks& ranks_;
    RingSettings settings_;  // lanes and group size chosen
    PeSegment pes_;          // of this rank
    RingJob job_;
    std::uint32_t share_ = 0;  // pixels of the PE that owns most
    PeMemory memory_;
    std::uint32_t window_ =
        0;  // pixels of each PE that lie on the device at a time: those of its memory, or some of them
    Communication communication_;
    Bus bus_;
    double build_s_ = 0;
    Buffer<std::uint32_t> broadcast_;
    Buffer<float> pixels_;         // [PE][3][window]
    std::vector<float> gathered_;  // on their way from there into the image: those of a range
    PixelRange gathered_range_;
    Buffer<std::uint8_t> marks_;  // what the first pass is given in place of marks
    std::unique_ptr<Tracer> tracer_;
    std::vector<PassCounters> counters_;  // of each phase
    std::unique_ptr<NeighbourExchange> exchange_;
    std::unique_ptr<RingFilter> filter_;
    std::unique_ptr<RingContrast> contrast_;

    // Of a render that keeps its state.
    const RingKeeping* keeping_ = nullptr;
    std::optional<RingState> resumed_;  // until the window is done in which it stood
    std::uint32_t band_ = 0;            // pixels of each PE's share
    double earlier_s_ = 0;              // of earlier runs
    Clock::time_point started_;
};

}  // namespace raya
