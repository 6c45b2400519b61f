// Renders a scene on a model of a ring machine: the host drives PEs, bus and ring; the kernels are the PEs.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/grid/accel.hpp"
#include "host/image/image.hpp"
#include "host/machine/load.hpp"
#include "host/machine/machine.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/bus.hpp"
#include "host/ring/contrast.hpp"
#include "host/ring/cost_image.hpp"
#include "host/ring/filter.hpp"
#include "host/ring/neighbour_exchange.hpp"
#include "host/ring/pe_memory.hpp"
#include "host/ring/schedule.hpp"
#include "host/ring/tracer.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"

namespace raya {

struct RingSettings {
    Machine machine;
    std::optional<DynamicPlan> dynamic;  // loads are those of a dynamic distribution, simulated from the pixels' costs
    raya_mapping mapping{};              // image size, PEs, which of them owns which pixel
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    Antialias antialias;
    Accel accel;
    KernelChoice kernels;
    std::uint32_t pixels_per_launch =
        0;  // of each PE; 0: as many as take about a second, so that progress can be shown
};

/// What was counted in one phase of a render.
struct Phase {
    std::string name;  // "trace", "supersample"
    EventCounts events{};
    Load load;       // modelled cycles of each PE, from its own counters
    CostImage cost;  // modelled cycles of each pixel
};

struct RingResult {
    Image image;
    std::vector<Phase> phases;              // the first pass, and supersampling where it was asked for
    Phase all;                              // their sums
    Image mask;                             // 1 where a pixel was supersampled, else 0; empty without supersampling
    std::uint64_t recomputed = 0;           // pixels supersampled
    std::optional<std::uint64_t> requests;  // of a simulated dynamic distribution
    Communication communication;
    PeMemory pe_memory;
    std::optional<AccelSummary> accel;  // of the grid that rays walked
    bool words_local = true;            // PEs copied the broadcast words into local memory at each launch
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    double build_s = 0, render_s = 0;  // measured on the host: kernel build; everything after it
    std::vector<LabelSummary> commands;
};

/// Seconds that tracing one image took on the device; by the host's clock where the device does not time its commands.
double trace_seconds(const RingResult& result);

class RingRenderer {
  public:
    /// Packs the scene, checks that it fits the machine's PEs, builds the kernels and takes the device memory.
    /// Throws UserError (what does not fit, what is out of range), DeviceError.
    RingRenderer(Session& session, const Scene& scene, const RingSettings& settings);

    /// One image. May be called again: the pixels are the same, the times are those of this call.
    RingResult render(const ProgressCallback& progress = {});

  private:
    void build(const Scene& scene);
    void build_exchange(KernelOptions options);
    void prepare(RingResult& result);
    void trace(std::uint32_t block, const ProgressCallback& progress);
    void supersample(const ProgressCallback& progress);
    void gather(std::uint32_t block, RingResult& result);
    void collect_costs(std::uint32_t block, RingResult& result);
    void collect_marks(RingResult& result);
    void collect_events(RingResult& result);
    void simulate_schedule(RingResult& result);
    void describe(RingResult& result);

    Session& session_;
    RingSettings settings_;  // lanes and group size chosen
    PackedJob job_;
    AccelSummary accel_;
    std::uint32_t share_ = 0;  // pixels of the PE that owns most
    PeMemory memory_;
    Communication communication_;
    Bus bus_;
    double build_s_ = 0;
    Buffer<std::uint32_t> broadcast_;
    Buffer<float> pixels_;        // [PE][block_pixels][3]
    Buffer<std::uint8_t> marks_;  // what the first pass is given in place of marks
    std::unique_ptr<Tracer> tracer_;
    std::vector<PassCounters> counters_;  // of each phase
    std::unique_ptr<NeighbourExchange> exchange_;
    std::unique_ptr<RingFilter> filter_;
    std::unique_ptr<RingContrast> contrast_;
};

}  // namespace raya
