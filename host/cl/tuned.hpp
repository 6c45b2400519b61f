// What a device was tuned to: values for lanes, group and what else changes a render's time and no bit of it, and the
// one place where a render takes them, or the defaults.
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

/// The kernels that values are for; others have other best ones.
struct TunedFor {
    bool torus = false;                     // else a ring
    std::uint32_t accel = RAYA_ACCEL_NONE;  // what a ring's rays walk through
    bool fp32 = true;                       // else a reduced format
    bool operator==(const TunedFor&) const = default;
};

/// One value of everything that is tuned; 0: the default, but for lanes and group, which are always named.
struct TunedValues {
    std::uint32_t lanes = 1, group = 1;
    std::uint32_t local_words = 1;  // 1: as KernelChoice::local_words, 0: words stay where they are
    std::uint32_t batch = 0, trees = 0, beams = 0, registers = 0;  // KernelTuning
    std::uint32_t link_exchange = 0;                               // LinkMove
    bool operator==(const TunedValues&) const = default;
};

/// The names under which values are printed and kept.
inline constexpr std::array<std::pair<const char*, std::uint32_t TunedValues::*>, 8> kTunedNames = {
    {{"lanes", &TunedValues::lanes},
     {"group", &TunedValues::group},
     {"local_words", &TunedValues::local_words},
     {"batch", &TunedValues::batch},
     {"trees", &TunedValues::trees},
     {"beams", &TunedValues::beams},
     {"registers", &TunedValues::registers},
     {"link_exchange", &TunedValues::link_exchange}}};

/// The defaults of a device, by which nothing is lost where nothing was tuned.
TunedValues default_values(const DeviceInfo& device, const TunedFor& what);

/// `kernels` with these values in place of its own; links as it says, where it says so. UserError for values that name
/// nothing.
KernelChoice with_values(KernelChoice kernels, const TunedValues& values);

/// What is known of a device: values, and where they come from ("FILE, DATE"). Empty: nothing.
struct TunedChoice {
    TunedValues values;
    std::string origin;
};
using TunedSource = std::function<std::optional<TunedChoice>(const DeviceInfo&, const TunedFor&)>;

/// While it lives, renders of this process that leave lanes and group open take what `source` knows. Without one, as in
/// `verify`, they take the defaults.
class TunedUse {
  public:
    explicit TunedUse(TunedSource source);
    ~TunedUse();
    TunedUse(const TunedUse&) = delete;
    TunedUse& operator=(const TunedUse&) = delete;

  private:
    TunedSource before_;
};

/// `kernels` with lanes and group chosen, and `origin` as reports tell it: "options" where the user has named either,
/// and then the rest is the default; else what is known of the device, or "defaults". `link_origin` is "options" where
/// the user has named links, and empty where they are left to the device.
KernelChoice chosen(KernelChoice kernels, const DeviceInfo& device, const TunedFor& what);

}  // namespace raya
