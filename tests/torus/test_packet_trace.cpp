// Packet trace. The numbers of rays and parents in its rows are compared with the names of rays in generated ray trees.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <map>
#include <string>
#include <vector>

#include "host/scene/split_mix.hpp"
#include "host/torus/torus_trace.hpp"
#include "tests/base/gunzip.hpp"

namespace raya {
namespace {

const std::string kHeading = "superstep,source,destination,kind,bytes,ray,parent\n";

/// A sent packet and its name: "17" is the primary ray of pixel 17, "17RT" the refracted ray of that ray's reflected
/// ray, "17RT+3" the shadow ray of "17RT" to light 3, and "17RT+3!" the return packet of that shadow ray.
struct SentPacket {
    PacketRecord record;
    std::string kind, name, parent;
};

class NamedRayTree {
  public:
    explicit NamedRayTree(std::uint64_t seed) : random_(seed) {}

    /// Adds the packets of the ray and of its subtree, each sent up to three times. `depth`: level of the deepest rays.
    void grow(std::uint32_t pixel, std::uint32_t path, std::uint32_t level, const std::string& name,
              std::uint32_t depth) {
        const std::string parent = level == 0 ? "" : name.substr(0, name.size() - 1);
        const std::uint32_t kind = level == 0           ? RAYA_KIND_PRIMARY
                                   : name.back() == 'R' ? RAYA_KIND_REFLECTED
                                                        : RAYA_KIND_REFRACTED;
        send(pixel, path, raya_state(kind, level, 0) | flags(), name, parent, below(4));
        send(pixel, path, raya_state(RAYA_KIND_RETURN, level, 0), name + "!", name, below(2));
        for (std::uint32_t light = 1 + below(3); light <= 65'535; light += 1 + below(3) * 30'000) {
            const std::string shadow = name + "+" + std::to_string(light);
            send(pixel, path, raya_state(RAYA_KIND_SHADOW, level, light) | flags(), shadow, name, below(3));
            send(pixel, path, raya_state(RAYA_KIND_RETURN, level, light), shadow + "!", shadow, below(2));
            if (below(2) == 0) break;
        }
        if (level == depth) return;
        // Bit 0: reflected ray, bit 1: refracted ray. Only levels 0 to 2 have both, so that the tree stays small.
        const std::uint32_t children = 1 + below(level < 3 ? 3 : 2);
        if (children & 1) grow(pixel, raya_path_reflected(path), level + 1, name + "R", depth);
        if (children & 2) grow(pixel, raya_path_refracted(path, level), level + 1, name + "T", depth);
    }

    std::vector<SentPacket> shuffled() {
        for (std::size_t i = sent_.size(); i > 1; --i) std::swap(sent_[i - 1], sent_[random_.next() % i]);
        return std::move(sent_);
    }

    std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(random_.next() % limit); }

  private:
    // Returns random values of RAYA_STATE_WIDE, _FOUND, _FRESH and _CHARGED, which do not identify a ray.
    std::uint32_t flags() { return below(16) * RAYA_STATE_WIDE; }

    void send(std::uint32_t pixel, std::uint32_t path, std::uint32_t state, const std::string& name,
              const std::string& parent, std::uint32_t times) {
        static const char* const kKinds[] = {"", "primary", "reflected", "refracted", "shadow", "return"};
        for (std::uint32_t i = 0; i < times; ++i) {
            PacketRecord record = {below(1000), below(65'536), below(65'536), {}, 0};
            record.head = {.pixel = pixel,
                           .state = state,
                           .path = path,
                           .weight = static_cast<float>(below(1u << 31)),
                           .carries = {.nearest = {below(1u << 31), below(1u << 31)}},
                           .voxel = below(1u << 31)};
            record.words = 6 + below(60);
            sent_.push_back({record, kKinds[raya_state_kind(state)], name, parent});
        }
    }

    SplitMix random_;
    std::vector<SentPacket> sent_;
};

// Returns the expected rows. Rays are numbered in the order in which their names first appear in the rows.
std::string expected_rows(const std::vector<SentPacket>& sent) {
    std::map<std::string, std::size_t> numbers;
    const auto number = [&](const std::string& name) { return numbers.emplace(name, numbers.size()).first->second; };
    std::string rows;
    for (const SentPacket& s : sent) {
        rows += fmt::format("{},{},{},{},{},{},", s.record.superstep, s.record.source, s.record.destination, s.kind,
                            4 * s.record.words, number(s.name));
        if (!s.parent.empty()) rows += std::to_string(number(s.parent));
        rows += "\n";
    }
    return rows;
}

TEST_CASE("random ray trees: rays and parents are numbered in order of appearance", "[torus]") {
    constexpr std::uint64_t kSeed = 2025;
    for (std::uint64_t i = 0; i < 100; ++i) {
        CAPTURE(kSeed, i);
        NamedRayTree tree(kSeed + i);
        const std::uint32_t pixels = 1 + tree.below(5);
        for (std::uint32_t p = 0; p < pixels; ++p) {
            const std::uint32_t pixel = p == 0 ? (1u << 28) - 1 : p << 20 | tree.below(1u << 20);
            tree.grow(pixel, 0, 0, std::to_string(pixel), tree.below(4) == 0 ? 31 : tree.below(8));
        }
        const std::vector<SentPacket> sent = tree.shuffled();
        PacketTrace trace;
        for (const SentPacket& s : sent) trace.add(s.record);
        CHECK(trace.rows() == sent.size());
        const bool same = gunzip(trace.finish()) == kHeading + expected_rows(sent);
        CHECK(same);
    }
}

}  // namespace
}  // namespace raya
