// Packet trace. The numbers of rays and parents in its rows are compared with the names of rays in generated ray trees.
#include <fmt/core.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <stdexcept>
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

raya_head head_of(std::uint32_t pixel, std::uint32_t state, std::uint32_t path) {
    raya_head head{};
    head.pixel = pixel;
    head.state = state;
    head.path = path;
    return head;
}

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
    for (std::uint64_t i = 0; i < 300; ++i) {
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

TEST_CASE("a shadow ray that is recorded after its return has the number of the return's parent", "[torus]") {
    PacketTrace trace;
    const auto row = [&](std::uint32_t kind, std::uint32_t level, std::uint32_t light, std::uint32_t path) {
        trace.add({3, 1, 2, head_of(9, raya_state(kind, level, light), path), kind == RAYA_KIND_RETURN ? 6u : 22u});
    };
    row(RAYA_KIND_RETURN, 1, 4, 1u << 31);     // number 0: return of the refracted ray's shadow ray
    row(RAYA_KIND_SHADOW, 1, 4, 1u << 31);     // number 1: parent of 0, child of 2
    row(RAYA_KIND_REFRACTED, 1, 0, 1u << 31);  // number 2: child of 3
    row(RAYA_KIND_PRIMARY, 0, 0, 0);           // number 3
    row(RAYA_KIND_REFLECTED, 1, 0, 0);         // number 4: child of 3
    CHECK(gunzip(trace.finish()) == kHeading +
                                        "3,1,2,return,24,0,1\n3,1,2,shadow,88,1,2\n3,1,2,refracted,88,2,3\n"
                                        "3,1,2,primary,88,3,\n3,1,2,reflected,88,4,3\n");
}

TEST_CASE("a trace without packets has only its heading", "[torus]") {
    PacketTrace trace;
    CHECK(trace.rows() == 0);
    CHECK(gunzip(trace.finish()) == kHeading);
}

TEST_CASE("invalid packet heads are refused", "[torus]") {
    const std::uint32_t wrong[] = {raya_state(RAYA_KIND_NONE, 0, 0),      raya_state(RAYA_KINDS, 0, 0),
                                   raya_state(RAYA_KIND_PRIMARY, 1, 0),   raya_state(RAYA_KIND_PRIMARY, 0, 1),
                                   raya_state(RAYA_KIND_REFLECTED, 0, 0), raya_state(RAYA_KIND_REFRACTED, 0, 0),
                                   raya_state(RAYA_KIND_REFLECTED, 1, 2), raya_state(RAYA_KIND_SHADOW, 0, 0)};
    for (const std::uint32_t state : wrong) {
        CAPTURE(state);
        PacketTrace trace;
        CHECK_THROWS_AS(trace.add({0, 0, 0, head_of(0, state, 0), 16}), std::logic_error);
    }
    CHECK_THROWS_AS(packet_kind_name(RAYA_KINDS), std::logic_error);
}

// Enters enough rays to make the table grow many times, then looks all of them up in reverse order.
TEST_CASE("a ray keeps its number while the table grows", "[torus]") {
    constexpr std::uint32_t kRays = 200'000;
    RayNumbers numbers;
    const auto ray = [](std::uint32_t i) { return RayId{i / 8, 1 + i % 4, i % 8 < 4 ? 0 : 1 + i % 65'535}; };
    for (std::uint32_t i = 0; i < kRays; ++i) REQUIRE(numbers.number_of(ray(i)) == i);
    for (std::uint32_t i = kRays; i-- > 0;) REQUIRE(numbers.number_of(ray(i)) == i);
    CHECK(numbers.next_number() == kRays);
    CHECK_THROWS_AS(numbers.number_of({0, 0, 0}), std::logic_error);
    CHECK_THROWS_AS(numbers.number_of({0, 1, 65'536}), std::logic_error);
}

}  // namespace
}  // namespace raya
