#include "host/checks/machines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "host/checks/patterns.hpp"
#include "host/kernels/kernels.hpp"
#include "host/ring/mapping.hpp"

namespace raya {
namespace {

using Words = std::vector<std::uint32_t>;

// Compares cases of `stride` words each; `what` tells a case, `names` its words.
template <class What>
Verdict compare_cases(const Words& expected, const Words& got, const std::vector<std::string>& names, const What& what,
                      const std::string& done) {
    const std::size_t stride = names.size();
    const auto differ = std::mismatch(expected.begin(), expected.end(), got.begin());
    if (differ.first == expected.end()) return passed(done);
    const auto at = static_cast<std::size_t>(differ.first - expected.begin());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < expected.size(); i += stride)
        wrong += !std::equal(&expected[i], &expected[i] + stride, &got[i]);
    return failed(fmt::format("{} of {} wrong", wrong, expected.size() / stride),
                  {.where = fmt::format("{} of {}", names[at % stride], what(at / stride)),
                   .expected = fmt::format("{0} = 0x{0:08x}", expected[at]),
                   .got = fmt::format("{0} = 0x{0:08x}", got[at])});
}

// By the same functions as kernels/checks/machine.cl's find_owners.
void add_owner(Words& to, const raya_mapping& m, const raya_pixel& pixel) {
    const std::uint32_t owner = raya_owner(m, pixel.row, pixel.column);
    const raya_share share = raya_share_of(m, owner);
    const std::uint32_t number = raya_index_of(m, share, pixel);
    const raya_pixel back = raya_pixel_of(m, share, number);
    std::uint32_t sides = 0;
    for (std::uint32_t side = 0; side < RAYA_SIDES; ++side)
        sides |= std::uint32_t{raya_has_neighbour(m, pixel, side) != 0} << side;
    to.insert(to.end(), {owner, raya_share_size(share), number, back.row, back.column, sides});
}

}  // namespace

CheckRunner machine_runner(Session& session, const KernelSources& sources, std::uint32_t group_size) {
    return {session, Kernels(session, {.group_size = group_size}, sources).program("checks/machine.cl")};
}

Verdict check_owners(CheckRunner& runner, std::uint32_t kind, std::size_t cases) {
    const auto [mappings, pixels] = mapping_cases(kind, cases);
    Words expected;
    for (std::size_t i = 0; i < cases; ++i) add_owner(expected, mappings[i], pixels[i]);
    const auto from = runner.filled("mappings", mappings);
    const auto at = runner.filled("pixels", pixels);
    auto owners = runner.poisoned("owners", expected.size());
    runner.run<const Buffer<raya_mapping>&, const Buffer<raya_pixel>&, cl_uint, Buffer<std::uint32_t>&>(
        "find_owners", cases, 1, from, at, static_cast<cl_uint>(cases), owners);
    const auto what = [&, &m = mappings, &p = pixels](std::size_t i) {
        return fmt::format("pixel (row {}, column {}) of {}x{} on {} PEs, {}", p[i].row, p[i].column, m[i].width,
                           m[i].height, m[i].pes, mapping_text(m[i]));
    };
    return compare_cases(expected, runner.read(owners),
                         {"owner", "size of the share", "number in the share", "row", "column", "neighbours"}, what,
                         fmt::format("{} pixels", cases));
}

Verdict check_ways(CheckRunner& runner, std::size_t cases) {
    const auto [toruses, nodes] = torus_cases(cases);
    Words expected;
    for (std::size_t i = 0; i < cases; ++i) {
        expected.push_back(raya_next_link(toruses[i], nodes[2 * i], nodes[2 * i + 1]));
        expected.push_back(raya_home_link(toruses[i], nodes[2 * i]));
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            expected.push_back(raya_link_end(toruses[i], nodes[2 * i], link));
    }
    const auto from = runner.filled("toruses", toruses);
    const auto at = runner.filled("nodes", nodes);
    auto ways = runner.poisoned("ways", expected.size());
    runner.run<const Buffer<raya_torus>&, const Buffer<std::uint32_t>&, cl_uint, Buffer<std::uint32_t>&>(
        "find_ways", cases, 1, from, at, static_cast<cl_uint>(cases), ways);
    const auto what = [&, &t = toruses, &n = nodes](std::size_t i) {
        return fmt::format("node {} to {} on {}", n[2 * i], n[2 * i + 1],
                           sides_text({t[i].sides[0], t[i].sides[1], t[i].sides[2]}));
    };
    return compare_cases(expected, runner.read(ways),
                         {"next link", "link home", "end of +x", "of -x", "of +y", "of -y", "of +z", "of -z"}, what,
                         fmt::format("{} pairs of nodes", cases));
}

Verdict check_local_memory(CheckRunner& runner, std::uint32_t group_size) {
    constexpr std::uint32_t kGroups = 64, kTimes = 9;
    const std::uint32_t words = 2000;  // 2 x 2000 words are half of the 32 KB that OpenCL promises
    Words from(std::size_t{kGroups} * words), expected(from.size());
    std::iota(from.begin(), from.end(), 0u);
    for (std::size_t i = 0; i < from.size(); ++i)  // an odd number of times: turned round
        expected[i] = from[i / words * words + (words - 1 - i % words)] + kTimes;
    const auto given = runner.filled("from", from);
    auto turned = runner.poisoned("to", from.size());
    auto drawn = runner.constant<std::uint32_t>("drawn", from.size(), 0);
    using Local = LocalMemory<std::uint32_t>;
    runner.run<const Buffer<std::uint32_t>&, cl_uint, cl_uint, Local, Local, Buffer<std::uint32_t>&,
               Buffer<std::uint32_t>&>("turn_round", kGroups, group_size, given, words, kTimes, Local{2 * words},
                                       Local{1}, turned, drawn);
    const auto what = [&](std::size_t i) { return fmt::format("group {}, word {}", i / words, i % words); };
    const std::string done = fmt::format("{} groups of {} words", kGroups, words);
    const Verdict verdict = compare_cases(expected, runner.read(turned), {"local memory"}, what, done);
    if (verdict.outcome != Outcome::kPass) return verdict;
    return compare_cases(Words(from.size(), 1), runner.read(drawn), {"draws of a number from the counter"}, what, done);
}

}  // namespace raya
