// Build options of the kernels for a device. build_options() makes all -D options.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/model/number_format.hpp"
#include "kernels/shared/job.h"

namespace raya {

/// The parameters of kernels/ (each RAYA_* macro is documented where the kernels define its default).
struct KernelOptions {
    std::uint32_t lanes = 1;       // V: number of lanes of a work-item
    std::uint32_t group_size = 1;  // L: work-items per work-group
    std::uint32_t bounces = 8;
    NumberFormat format{};
    bool exact_divide = true;  // use the device's division and square root if correctly rounded; false: refine them
    bool exact_fma = true;     // use the device's fused multiply-add; false: emulate it
    bool words_local = true;   // work-groups copy the job's words (scene and settings) into local memory
    std::uint32_t accel = RAYA_ACCEL_NONE;  // accelerator of the job
    std::uint32_t stack = 0;                // RAYA_BVH_STACK: number of entries of the traversal stack
    bool filter = false;  // filter spheres and polygons in fp32 before the exact test, see filters_are_valid()
    // `polygons`, `cones`: true if the scene has such objects; patches are polygons with vertex normals.
#define RAYA_HAS_KIND(kind, kinds, KIND) bool kinds = true;
    RAYA_SHAPE_LIST(RAYA_HAS_KIND)
    bool patches = true;
    bool costs = false;              // torus nodes record the cost of each packet
    bool packets = false;            // ring: RingSettings::packets
    std::uint32_t sphere_batch = 0;  // RAYA_SPHERE_BATCH: spheres tested before their hits are examined; 0: default
};

/// Kernel settings that the user, a check or tuning chooses for a device.
struct KernelChoice {
    std::uint32_t lanes = 0;       // V: 1, 4, 8 or 16; 0: chosen from the device
    std::uint32_t group_size = 0;  // L: 1..1024 work-items; 0: chosen from the device
    bool filter = true;            // use the fp32 filters if filters_are_valid(); they do not change the hits
    // If one of the next two members is false, the kernels use replacement code, even if the device does not need it.
    bool local_words = true;       // keep the job's words in local memory if they fit; false: in global memory
    bool exact_arithmetic = true;  // use the device's division, square root and fused multiply-add if they are
                                   // correctly rounded; false: refine or emulate them
    KernelSources sources{};
    std::uint32_t sphere_batch = 0;  // as KernelOptions::sphere_batch
    std::string origin{};            // for reports: source of lanes, group size and batch, see chosen_kernels()
};

/// Returns the default V. On a CPU it is the width of the device's float vectors, at least 4. On other devices it is 1,
/// also on llvmpipe, which vectorises over work-items and takes minutes and gigabytes to compile wider kernels.
std::uint32_t default_lanes(const DeviceInfo& device);

/// Returns the default L. On a CPU it is 1, because a work-item's lanes fill the vectors. On llvmpipe it is 8,
/// because llvmpipe vectorises over work-items with 256-bit vectors. For a torus it is 1 on every CPU, because a node
/// of one work-item keeps packets in order (docs/architecture.md). On other devices it is 128, or, if `pes` is not 0,
/// the power of 2 from 32 to 256 with which that many PEs have about 512 work-items on each compute unit: the fastest
/// size for a ring without acceleration structure on an H100 (docs/porting.md).
std::uint32_t default_group_size(const DeviceInfo& device, bool torus = false, std::uint32_t pes = 0);

/// Returns true if the error bounds of kernels/geometry/sphere_filter.clh and outline_filter.clh are valid: `format` is
/// a reduced format with at least 10 fraction bits, and the scene's `extent` (scene units) is so small that squares do
/// not overflow. The filters change the time of a render, not its result.
bool filters_are_valid(const NumberFormat& format, double extent);

/// Returns the maximum group size of the kernels on this device.
std::uint32_t max_group_size_of(const DeviceInfo& device);

/// Throws UserError for lanes other than 1, 4, 8, 16, a group size outside 1..max_group_size_of(), more than 31
/// bounces, or tuning parameters outside their ranges.
void check_kernel_options(const KernelOptions& options, const DeviceInfo& device);

/// Returns the build options of all kernels, including -cl-fp32-correctly-rounded-divide-sqrt if it is wanted and the
/// device supports it. Throws as check_kernel_options().
std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device);

// Tuned values of a device (lanes, group size and the other parameters that change only the time of a render), and the
// choice of values for a render.

/// The kind of render that a set of values was tuned for.
struct TuningKey {
    bool torus = false;                     // false: a ring
    std::uint32_t accel = RAYA_ACCEL_NONE;  // acceleration structure of a ring
    bool fp32 = true;                       // false: a reduced format
    bool operator==(const TuningKey&) const = default;
};

/// The tuned parameters. 0 means the default, except for lanes and group, which always have a value.
struct TunedValues {
    std::uint32_t lanes = 1, group = 1;
    std::uint32_t local_words = 1;  // 1: as KernelChoice::local_words; 0: the job's words stay in global memory
    std::uint32_t batch = 0;        // KernelChoice::sphere_batch
    bool operator==(const TunedValues&) const = default;
};

/// Returns the default values for a device that was not tuned. `pes`: number of PEs, 0 if unknown.
TunedValues default_values(const DeviceInfo& device, const TuningKey& key, std::uint32_t pes = 0);

/// Returns `kernels` with these values.
KernelChoice with_values(KernelChoice kernels, const TunedValues& values);

/// Tuned values and their source ("FILE, DATE").
struct TunedChoice {
    TunedValues values;
    std::string origin;
};
/// Returns the tuned values for a device and a kind of render; nothing if there are none.
using TunedSource = std::function<std::optional<TunedChoice>(const DeviceInfo&, const TuningKey&)>;

/// While this object exists, renders of this process for which the user sets neither lanes nor group size use the
/// values from `source`. Without such an object, as in `raya verify`, they use the defaults.
class ScopedTunedSource {
  public:
    explicit ScopedTunedSource(TunedSource source);
    ~ScopedTunedSource();
    ScopedTunedSource(const ScopedTunedSource&) = delete;
    ScopedTunedSource& operator=(const ScopedTunedSource&) = delete;

  private:
    TunedSource previous_source_;
};

/// Returns `kernels` with lanes, group size and tuning chosen. If the user has set lanes or group size, a value that
/// the user has not set gets its default, and `origin` is "options". Otherwise, if the tuned source has values, these
/// and their origin apply. Without tuned values the defaults apply, and `origin` is "defaults".
KernelChoice chosen_kernels(KernelChoice kernels, const DeviceInfo& device, const TuningKey& key,
                            std::uint32_t pes = 0);

// Typed access to kernels: each kernel is declared once, as a type with its file, name and parameters.

/// A kernel: its file below kernels/, its name in that file, and its parameter types as in Kernel. The types of
/// adjacent uint parameters contain the parameters' names (Uint), so that a caller cannot swap the arguments.
template <FixedText File, FixedText Name, class... Params>
struct DescribedKernel : Kernel<Params...> {
    static constexpr const char* kFile = File.text;

    explicit DescribedKernel(const Program& program)
        : Kernel<Params...>(program.kernel<Params...>(std::string(Name.text))) {}
};

/// The kernels for one device with one set of build options. Each file is built as one program.
class Kernels {
  public:
    /// Makes kernels for the device of `session`, which must outlive this object. Throws as build_options().
    Kernels(Session& session, const KernelOptions& options, const KernelSources& sources = {});

    /// Returns the kernel `K`, a DescribedKernel. Throws UserError if there is no such file, DeviceError if the build
    /// fails or the number of parameters differs.
    template <class K>
    K get() const {
        return K(program(K::kFile));
    }

    /// Returns the program built from a file below kernels/. Throws as get().
    Program program(const std::string& file) const;

    /// Builds the source `text`, which is not a file of kernels/ but may include such files; `name` is for messages.
    Program build(const std::string& name, const std::string& text) const;

    Session& session() const { return session_; }
    const KernelOptions& options() const { return options_; }

  private:
    Session& session_;
    KernelOptions options_;
    KernelSources sources_;
    std::vector<std::string> build_options_;
};

}  // namespace raya
