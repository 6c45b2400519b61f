// Renderer on a model of a ring machine: kernels model the PEs; the host launches them and performs the transfers of
// bus and ring.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/array/checkpoints.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/ring_result.hpp"
#include "host/ring/turns.hpp"
#include "host/scene/scene.hpp"

namespace raya {

class RingRenderer {
  public:
    /// Packs the scene, checks that it fits a PE's memory, builds the kernels and allocates the device memory for the
    /// PEs of this rank. Only rank 0 uses `scene`; it calls `packed`, if not empty, when it no longer needs the scene's
    /// objects. Throws UserError if the scene does not fit, a setting is out of
    /// range or there are more ranks than PEs, and DeviceError if the device fails.
    RingRenderer(Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks = Ranks::single(),
                 const std::function<void()>& packed = {});

    /// Renders one image. May be called repeatedly. In ranks other than 0 the result covers only this rank and has no
    /// image. With `checkpointing` the image is traced in bands, and a checkpoint may be saved after each band. A
    /// resumed render returns the same image and counts as an uninterrupted one; its times are the sums over all runs.
    RingResult render(const ProgressCallback& progress = {}, const Checkpointing* checkpointing = nullptr);

    /// Returns the power of two by which the scene's lengths are multiplied.
    const LengthScale& scale() const { return job_.scale; }

  private:
    bool records_costs() const { return settings_.record_costs || settings_.dynamic.has_value(); }
    void build();
    void build_exchange(KernelOptions options);
    void prepare(RingResult& result);
    void render_block(std::uint32_t block_begin, RingResult& result, const ProgressCallback& progress);
    void trace(std::uint32_t pass, PixelRange range, RingResult& result, const ProgressCallback& progress);
    StateSettings state_settings() const;
    void visit_state(RenderState& state, RingResult& result);
    void resume(RingResult& result);
    void gather(PixelRange range, RingResult& result);
    void collect_costs(PixelRange range, RingResult& result);
    void collect_marks(RingResult& result);
    void collect_events(RingResult& result);
    void simulate_schedule(RingResult& result);
    void describe(RingResult& result);

    Session& session_;
    Ranks& ranks_;
    RingSettings settings_;  // with lanes and group size chosen
    Distribution pes_;
    RingJob job_;
    StoredScene stored_;
    std::uint32_t share_pixels_ = 0;  // maximum number of pixels that a PE owns
    PeMemory memory_;
    // Number of pixels of each PE on the device at a time: a block (PeMemory) or a part of a block.
    std::uint32_t window_ = 0;
    Communication communication_;
    Bus bus_;
    double build_s_ = 0;
    Buffer<std::uint32_t> broadcast_;  // words of the job
    Buffer<float> pixels_;             // [PE][3][window]
    Buffer<std::uint8_t> no_marks_;    // dummy argument of the first pass, which has no marks
    std::unique_ptr<SampleTracer> tracer_;
    Turns* turns_ = nullptr;              // tracer_, if the objects are divided
    std::vector<PassCounters> counters_;  // one for each pass
    std::unique_ptr<RingFilter> filter_;
    std::unique_ptr<RingContrast> contrast_;

    // State of a render with checkpoints.
    std::optional<Checkpoints> checkpoints_;
    struct {
        std::uint32_t pass = 0;    // current pass: 0 trace, 1 supersample
        std::uint32_t window = 0;  // index, in each PE's share, of the first pixel that is on the device
        std::uint32_t next = 0;    // index, in each PE's share, of the first pixel that this pass has not traced
    } position_;
    bool resumed_ = false;    // position_ is that of a checkpoint, whose window has not been gathered yet
    std::uint32_t band_ = 0;  // length of the next band, in pixels of each PE's share
};

}  // namespace raya
