#include "host/ring/pe_memory.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/model/machine.hpp"
#include "host/model/unit_text.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kPendingRayWords = 7;  // a pending ray on the stack: origin, direction, weight
// State of a ray tree except the stack: ray, hit, normal, mirror direction, tint, sum, counters.
constexpr std::uint64_t kRayTreeWords = 32;
constexpr std::uint64_t kPixelBytes = 12;  // three colour components of 4 bytes

[[noreturn]] void refuse(const Machine& machine, const std::string& what, std::uint64_t bytes,
                         const std::string& remedy) {
    const char* memory_remedy = machine.name == "grande" ? "a larger --pe-memory, or none" : "--machine grande";
    throw DoesNotFit(
        fmt::format("{}: needs {} in every PE, a PE of {} has {}; use {}{}", what, required_size_text(bytes),
                    machine.title, available_size_text(*machine.pe_memory_bytes), remedy, memory_remedy),
        bytes, *machine.pe_memory_bytes);
}

}  // namespace

PeMemory plan_pe_memory(const Machine& machine, const PeDemand& demand) {
    PeMemory memory{.job_words = demand.job_words, .tree_words = kRayTreeWords + kPendingRayWords * demand.bounces};
    const bool antialiased = demand.antialias != AntialiasMethod::kNone;
    // The number of pixels that is reduced until the PE's memory suffices.
    std::uint32_t& fitted_pixels = antialiased ? memory.band_pixels : memory.block_pixels;
    if (antialiased) memory.block_pixels = demand.share_pixels;
    if (demand.antialias == AntialiasMethod::kFilter) memory.sum_pixels = demand.share_pixels;
    if (demand.antialias == AntialiasMethod::kSupersample) memory.marks = demand.share_pixels;
    const std::uint64_t fixed_bytes = memory.bytes();
    fitted_pixels = demand.share_pixels;
    if (!machine.pe_memory_bytes || memory.bytes() <= *machine.pe_memory_bytes) return memory;

    const std::uint64_t limit_bytes = *machine.pe_memory_bytes;
    if (fixed_bytes + kPixelBytes > limit_bytes && antialiased)
        refuse(machine, fmt::format("{} with --antialias {}", demand.scene, antialias_name(demand.antialias)),
               fixed_bytes + kPixelBytes, "more PEs, a smaller image or ");
    if (fixed_bytes + kPixelBytes > limit_bytes) refuse(machine, demand.scene, fixed_bytes + kPixelBytes, "");
    fitted_pixels = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(demand.share_pixels, (limit_bytes - fixed_bytes) / kPixelBytes));
    if (antialiased) {
        const std::uint32_t bands = (demand.share_pixels + fitted_pixels - 1) / fitted_pixels;
        fitted_pixels = (demand.share_pixels + bands - 1) / bands;
    }
    return memory;
}

}  // namespace raya
