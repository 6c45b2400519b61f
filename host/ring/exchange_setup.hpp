// What the kernels of the neighbour exchange are built and launched with.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/kernels/kernel_source.hpp"

namespace raya {

struct ExchangeSetup {
    Session& session;
    Buffer<std::uint32_t> broadcast;  // the job's words
    std::uint32_t pes = 0;
    std::uint32_t capacity = 0;  // pixels in the memory of each PE
    std::uint32_t group_size = 1;
    std::vector<std::string> build_options;  // with one lane
    KernelSources sources;
};

}  // namespace raya
