// What a render on a ring machine is asked for.
#pragma once
#include <cstdint>
#include <optional>

#include "host/cl/kernel_options.hpp"
#include "host/model/accel.hpp"
#include "host/model/machine.hpp"
#include "host/ring/antialias.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

struct RingSettings {
    Machine machine;
    std::optional<DynamicPlan> dynamic;  // loads are those of a dynamic distribution, simulated from the pixels' costs
    raya_mapping mapping{};              // image size, PEs, which of them owns which pixel
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    Antialias antialias;
    bool keep_costs = false;  // of each pixel, 8 bytes on the host; a dynamic distribution keeps them by itself
    Accel accel;
    KernelChoice kernels;
    std::uint64_t device_pixels = 1 << 22;  // of all PEs that lie on the device at a time, 20 bytes each; smoothed
                                            // images lie there as a whole
    std::uint32_t work_per_launch = 0;      // tests and steps of a lane's rays; 0: as much as takes about a second
};

}  // namespace raya
