// The ring machine: a scene in, an image and everything that was counted on the way out.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cl/commands.hpp"
#include "image/image.hpp"
#include "machine/machine.hpp"
#include "report/communication.hpp"
#include "report/load.hpp"
#include "ring/bus.hpp"
#include "ring/pe_memory.hpp"
#include "scene/packer.hpp"
#include "scene/scene.hpp"

namespace raya {

/// How the kernels are built for a device. 0: chosen from the device.
struct KernelChoice {
    std::uint32_t lanes = 0;                // V: 1, 4, 8 or 16
    std::uint32_t group_size = 0;           // L: 1..64 work-items
    bool filter = true;                     // the sphere filter, where it holds: the same hits, sooner
    std::filesystem::path kernel_dir;       // kernels from disk in place of the program's own
    std::vector<std::string> more_options;  // appended to the build options
};

struct RingSettings {
    Machine machine;
    raya_mapping mapping{};  // image size, PEs, offset, fold
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    KernelChoice kernels;
    std::uint32_t pixels_per_launch =
        0;  // of each PE; 0: as many as take about a second, so that progress can be shown
};

struct RingResult {
    Image image;
    GreyImage cost;  // modelled cycles of each pixel
    EventCounts events{};
    Load load;  // modelled cycles of each PE, from its own counters
    Communication communication;
    PeMemory pe_memory;
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    double build_s = 0, render_s = 0;  // measured on the host: kernel build; everything after it
    std::vector<LabelSummary> commands;
};

/// Seconds that the kernels of one image took on the device; by the host's clock where the device does not time its
/// commands.
double trace_seconds(const RingResult& result);

/// Called now and then with the share of the pixels that are done, 0..1.
using ProgressCallback = std::function<void(double)>;

class RingRenderer {
  public:
    /// Packs the scene, checks that it fits the machine's PEs, builds the kernels and takes the device memory.
    /// Throws UserError (what does not fit, what is out of range), DeviceError.
    RingRenderer(Session& session, const Scene& scene, const RingSettings& settings);

    /// One image. May be called again: the pixels are the same, the times are those of this call.
    RingResult render(const ProgressCallback& progress = {});

  private:
    using TraceKernel =
        Kernel<const Buffer<std::uint32_t>&, cl_uint, cl_uint, cl_uint, cl_uint, cl_uint, LocalMemory<std::uint32_t>,
               Buffer<float>&, Buffer<std::uint64_t>&, Buffer<std::uint64_t>&>;

    void build();
    void launch_trace(const std::string& label, std::uint32_t block, std::uint32_t begin, std::uint32_t end);
    void prepare(RingResult& result);
    void trace(std::uint32_t block, const ProgressCallback& progress);
    void gather(std::uint32_t block, RingResult& result);
    void collect_events(RingResult& result);
    void describe(RingResult& result);

    Session& session_;
    RingSettings settings_;  // lanes and group size chosen
    bool filter_ = false;    // see sphere_filter_holds
    PackedJob job_;
    std::uint32_t share_ = 0;  // pixels of the PE that owns most
    PeMemory memory_;
    std::uint32_t slice_ = 0;  // pixels of each share that one launch traces
    bool words_local_ = true;
    std::string build_options_;
    double build_s_ = 0;
    Communication communication_;
    Bus bus_;
    Buffer<std::uint32_t> broadcast_;
    Buffer<float> pixels_;          // [PE][block_pixels][3]
    Buffer<std::uint64_t> cycles_;  // [PE][block_pixels]
    Buffer<std::uint64_t> events_;  // [PE][L][RAYA_EVENTS]
    std::unique_ptr<TraceKernel> trace_;
};

}  // namespace raya
