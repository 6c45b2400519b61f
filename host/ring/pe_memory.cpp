#include "host/ring/pe_memory.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/model/machine.hpp"
#include "host/model/unit_text.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kWaitingRayWords = 7;  // a pending ray on the stack: origin, direction, weight
constexpr std::uint64_t kRayTreeWords = 32;    // current ray, hit, normal, mirror direction, tint, sum, counters
constexpr std::uint64_t kPixelBytes = 12;

[[noreturn]] void refuse(const Machine& machine, const std::string& what, std::uint64_t bytes,
                         const std::string& remedy) {
    const char* other = machine.name == "grande" ? "a larger --pe-memory, or none" : "--machine grande";
    throw DoesNotFit(
        fmt::format("{}: needs {} in every PE, a PE of {} has {}; use {}{}", what, required_size_text(bytes),
                    machine.title, available_size_text(*machine.pe_memory_bytes), remedy, other),
        bytes, *machine.pe_memory_bytes);
}

}  // namespace

PeMemory plan_pe_memory(const Machine& machine, const PeDemand& demand) {
    PeMemory memory{.job_words = demand.job_words, .tree_words = kRayTreeWords + kWaitingRayWords * demand.bounces};
    const bool exchanges = demand.antialias != AntialiasMethod::kNone;
    std::uint32_t& varied = exchanges ? memory.band_pixels : memory.block_pixels;
    if (exchanges) memory.block_pixels = demand.share;
    if (demand.antialias == AntialiasMethod::kFilter) memory.sum_pixels = demand.share;
    if (demand.antialias == AntialiasMethod::kSupersample) memory.marks = demand.share;
    const std::uint64_t fixed = memory.bytes();
    varied = demand.share;
    if (!machine.pe_memory_bytes || memory.bytes() <= *machine.pe_memory_bytes) return memory;

    const std::uint64_t limit = *machine.pe_memory_bytes;
    if (fixed + kPixelBytes > limit && exchanges)
        refuse(machine, fmt::format("{} with --antialias {}", demand.scene, antialias_name(demand.antialias)),
               fixed + kPixelBytes, "more PEs, a smaller image or ");
    if (fixed + kPixelBytes > limit) refuse(machine, demand.scene, fixed + kPixelBytes, "");
    varied = static_cast<std::uint32_t>(std::min<std::uint64_t>(demand.share, (limit - fixed) / kPixelBytes));
    if (exchanges) {
        const std::uint32_t bands = (demand.share + varied - 1) / varied;
        varied = (demand.share + bands - 1) / bands;
    }
    return memory;
}

}  // namespace raya
