#include "ring/pe_memory.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "error.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kWaitingRayWords = 7;  // origin, direction, weight
constexpr std::uint64_t kWalkWords = 32;       // the ray, its hit, normal, mirror direction, tint, sum and counters

}  // namespace

PeMemory plan_pe_memory(const Machine& machine, const std::string& scene, std::uint64_t job_words,
                        std::uint32_t bounces, std::uint32_t share) {
    PeMemory memory{job_words, kWalkWords + kWaitingRayWords * bounces, share};
    if (!machine.pe_memory_bytes || memory.bytes() <= *machine.pe_memory_bytes) return memory;
    memory.block_pixels = 0;
    const std::uint64_t limit = *machine.pe_memory_bytes, fixed = memory.bytes();
    if (fixed + 12 > limit) {
        throw UserError(fmt::format("{}: needs {:.1f} KB in every PE, a PE of {} has {} KB; use --machine grande",
                                    scene, static_cast<double>(fixed + 12) / 1024, machine.title, limit / 1024));
    }
    memory.block_pixels = static_cast<std::uint32_t>(std::min<std::uint64_t>(share, (limit - fixed) / 12));
    return memory;
}

}  // namespace raya
