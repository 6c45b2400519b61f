// Tuned values of a device (lanes, group size and the other parameters that change only the time of a render), and the
// choice of values for a render.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"

namespace raya {

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
    std::uint32_t batch = 0, trees = 0, beams = 0, registers = 0;  // see KernelTuning
    std::uint32_t link_exchange = 0;                               // a LinkMove
    bool operator==(const TunedValues&) const = default;
};

/// The names of the values in output and files.
inline constexpr std::array<std::pair<const char*, std::uint32_t TunedValues::*>, 8> kTunedNames = {
    {{"lanes", &TunedValues::lanes},
     {"group", &TunedValues::group},
     {"local_words", &TunedValues::local_words},
     {"batch", &TunedValues::batch},
     {"trees", &TunedValues::trees},
     {"beams", &TunedValues::beams},
     {"registers", &TunedValues::registers},
     {"link_exchange", &TunedValues::link_exchange}}};

/// Returns the default values for a device that was not tuned. `pes`: number of PEs, 0 if unknown.
TunedValues default_values(const DeviceInfo& device, const TuningKey& key, std::uint32_t pes = 0);

/// Returns `kernels` with these values. If kernels.link_move is not kAutomatic, it stays unchanged. Throws UserError if
/// link_exchange is out of range.
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
/// and their origin apply. Without tuned values the defaults apply, and `origin` is "defaults". `link_origin` is
/// "options" if the user has set the link move, `origin` if the tuned values set it, and empty if it stays kAutomatic.
KernelChoice chosen_kernels(KernelChoice kernels, const DeviceInfo& device, const TuningKey& key,
                            std::uint32_t pes = 0);

}  // namespace raya
