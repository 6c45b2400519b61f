#include "host/tune/space.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace raya {
namespace {

using Values = std::vector<std::uint32_t>;

// Powers of two from `least` on.
Values group_sizes(std::uint32_t least, std::uint32_t most) {
    Values all;
    for (std::uint32_t size = least; size <= most; size *= 2) all.push_back(size);
    if (all.empty()) all.push_back(most);
    return all;
}

constexpr auto kByCopies = static_cast<std::uint32_t>(LinkMove::kCopies);
constexpr auto kByKernel = static_cast<std::uint32_t>(LinkMove::kKernel);

// The default is one of the values, whatever the device.
void add_default(Values& values, std::uint32_t value) {
    if (std::find(values.begin(), values.end(), value) == values.end())
        values.insert(std::lower_bound(values.begin(), values.end(), value), value);
}

std::string value_text(const Knob& knob, std::uint32_t value) {
    if (knob.value == &TunedValues::local_words) return value ? "yes" : "no";
    if (knob.value == &TunedValues::link_exchange && value)
        return static_cast<LinkMove>(value) == LinkMove::kKernel ? "kernel" : "copies";
    return value ? std::to_string(value) : "own";
}

}  // namespace

const char* Knob::name() const {
    return std::find_if(kTunedNames.begin(), kTunedNames.end(), [this](const auto& n) { return n.second == value; })
        ->first;
}

std::size_t Space::size() const {
    std::size_t product = 1;
    for (const Knob& knob : knobs) product *= knob.values.size();
    return product;
}

TunedValues Space::values_of(const Candidate& candidate) const {
    TunedValues values = defaults;
    for (std::size_t k = 0; k < knobs.size(); ++k) values.*knobs[k].value = knobs[k].values[candidate[k]];
    return values;
}

void for_each_candidate(const Space& space, const std::function<void(const Candidate&)>& visit) {
    Candidate candidate(space.knobs.size(), 0);
    for (;;) {
        visit(candidate);
        std::size_t k = 0;
        while (k < candidate.size() && ++candidate[k] == space.knobs[k].values.size()) candidate[k++] = 0;
        if (k == candidate.size()) return;
    }
}

Space space_of(const DeviceInfo& device, const TunedFor& what) {
    Space space{.knobs = {}, .defaults = default_values(device, what), .start = {}};
    const bool cpu = device.type == "cpu", all_objects = what.accel == RAYA_ACCEL_NONE;
    const auto add = [&](std::uint32_t TunedValues::*value, Values values) {
        add_default(values, space.defaults.*value);
        const auto at = std::find(values.begin(), values.end(), space.defaults.*value);
        space.start.push_back(static_cast<std::size_t>(at - values.begin()));
        space.knobs.push_back({value, std::move(values)});
    };
    const std::uint32_t most = most_group_size(device);
    const bool llvmpipe = device.loop_turns > 0;  // vectors of work-items; minutes and gigabytes for several lanes
    add(&TunedValues::lanes, llvmpipe ? Values{1} : Values{1, 4, 8, 16});
    // A CPU's torus nodes keep their default, which keeps the order of packets (docs/packets.md).
    const std::uint32_t most_on_cpu = what.torus ? space.defaults.group : std::min(llvmpipe ? 16u : 4u, most);
    add(&TunedValues::group, cpu ? group_sizes(1, most_on_cpu) : group_sizes(16, most));
    if (takes_register_limit(device)) add(&TunedValues::registers, {0, 64, 96, 128, 168});
    if (all_objects) add(&TunedValues::local_words, {0, 1});
    if (all_objects && what.fp32 && !what.torus)
        add(&TunedValues::batch, cpu ? Values{0, 8, 16} : Values{0, 4, 8, 16, 32});
    if (what.accel == RAYA_ACCEL_GRID) {
        add(&TunedValues::trees, {0, 1, 2, 4, 8});
        add(&TunedValues::beams, {0, 1, 2, 4, 8});
    }
    // A CPU's own choice is the kernel.
    if (what.torus) add(&TunedValues::link_exchange, cpu ? Values{0, kByCopies} : Values{0, kByCopies, kByKernel});
    return space;
}

std::string change_text(const Space& space, const TunedValues& from, const TunedValues& to) {
    std::string text;
    for (const Knob& knob : space.knobs) {
        std::string name = knob.name();
        std::replace(name.begin(), name.end(), '_', ' ');
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value_text(knob, from.*knob.value));
        if (from.*knob.value != to.*knob.value) text += " -> " + value_text(knob, to.*knob.value);
    }
    return text;
}

}  // namespace raya
