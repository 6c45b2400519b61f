#include "host/torus/packet_trace.hpp"

#include <fmt/core.h>

#include <array>
#include <iterator>
#include <optional>
#include <stdexcept>

namespace raya {
namespace {

constexpr std::size_t kBlock = 1 << 16;  // bytes of text that are compressed at a time
constexpr std::uint32_t kWordBytes = 4;

// A packet's own number and its parent's, which a primary ray lacks.
struct Lineage {
    std::uint64_t ray = 0;
    std::optional<std::uint64_t> parent;
};

// A return packet leaves the node that made it once and is nobody's parent, so its number need not be kept.
Lineage lineage_of(RayNumbers& numbers, const PacketRecord& record) {
    const std::uint32_t state = record.head.state, kind = raya_state_kind(state);
    const RayName name = {record.head.pixel, RayName::place_of(record.head.path, raya_state_level(state)),
                          raya_state_light(state)};
    Lineage lineage;
    lineage.ray = kind == RAYA_KIND_RETURN ? numbers.next() : numbers.number_of(name);
    if (kind == RAYA_KIND_RETURN)
        lineage.parent = numbers.number_of(name);
    else if (kind != RAYA_KIND_PRIMARY)
        lineage.parent = numbers.number_of(name.parent());
    return lineage;
}

// What only a mistake in a kernel can make; a wrong row would be worse than none.
void check_head(const PacketRecord& record) {
    const std::uint32_t state = record.head.state, kind = raya_state_kind(state);
    const bool root_of_tree = raya_state_level(state) == 0, has_light = raya_state_light(state) != 0;
    const bool right =
        kind == RAYA_KIND_RETURN || (has_light == (kind == RAYA_KIND_SHADOW) &&
                                     (kind == RAYA_KIND_SHADOW || root_of_tree == (kind == RAYA_KIND_PRIMARY)));
    if (!right) throw std::logic_error(fmt::format("packet trace: a packet with state {:#x}", state));
}

}  // namespace

const char* packet_kind_name(std::uint32_t kind) {
    constexpr std::array<const char*, RAYA_KINDS> kNames = {"",          "primary", "reflected",
                                                            "refracted", "shadow",  "return"};
    if (kind == RAYA_KIND_NONE || kind >= kNames.size())
        throw std::logic_error(fmt::format("no kind of packet has number {}", kind));
    return kNames[kind];
}

PacketTrace::PacketTrace() : text_("superstep,source,destination,kind,bytes,ray,parent\n") {}

void PacketTrace::add(const PacketRecord& record) {
    const std::uint32_t state = record.head.state;
    const char* const kind = packet_kind_name(raya_state_kind(state));
    check_head(record);
    const Lineage lineage = lineage_of(numbers_, record);
    auto to = std::back_inserter(text_);
    fmt::format_to(to, "{},{},{},{},{},{},", record.superstep, record.source, record.destination, kind,
                   kWordBytes * record.words, lineage.ray);
    if (lineage.parent) fmt::format_to(to, "{}", *lineage.parent);
    text_ += '\n';
    ++rows_;
    if (text_.size() < kBlock) return;
    file_.append(text_);
    text_.clear();
}

std::string PacketTrace::finish() {
    file_.append(text_);
    return file_.finish();
}

}  // namespace raya
