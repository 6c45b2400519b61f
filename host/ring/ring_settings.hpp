// What a render on a ring machine is asked for.
#pragma once
#include <cstdint>
#include <optional>

#include "host/grid/accel.hpp"
#include "host/kernels/kernel_options.hpp"
#include "host/machine/machine.hpp"
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
    Accel accel;
    KernelChoice kernels;
    std::uint32_t pixels_per_launch =
        0;  // of each PE; 0: as many as take about a second, so that progress can be shown
};

}  // namespace raya
