// What the machines rest on beside numbers: whole-number arithmetic in kernels, local memory and barriers, and copies
// between buffers. All of it is exact.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>

#include "host/ring/bus.hpp"
#include "host/verify/patterns.hpp"
#include "host/verify/verify.hpp"
#include "host/verify/words.hpp"

namespace raya {
namespace {

using Words = std::vector<std::uint32_t>;

std::vector<std::string> remedies() {
    return {
        "the compiler is wrong about whole numbers or barriers, not about fp32: look for a switch of the driver that\n"
        "turns its optimiser off, and tell its makers",
        "a newer driver, or another OpenCL implementation for this device (raya devices)"};
}

// Compares cases of `stride` words each; `what` tells a case, `names` its words.
template <class What>
Verdict compare_cases(const Words& expected, const Words& got, const std::vector<std::string>& names,
                      const std::string& options, const What& what, const std::string& done) {
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
                   .got = fmt::format("{0} = 0x{0:08x}", got[at]),
                   .options = options,
                   .remedies = remedies()});
}

// By the same functions as kernels/verify/machine.cl's find_owners.
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

Verdict check_owners(const Verification& v, Session& session, std::uint32_t kind) {
    const std::size_t cases = v.full() ? 50'000 : 5'000;
    const auto [mappings, pixels] = mapping_cases(kind, cases);
    Words expected;
    for (std::size_t i = 0; i < cases; ++i) add_owner(expected, mappings[i], pixels[i]);
    const Program program = v.build(session, "verify/machine.cl", {});
    auto mapping_buffer = session.buffer<raya_mapping>("mappings", cases);
    auto pixel_buffer = session.buffer<raya_pixel>("pixels", cases);
    auto results = session.buffer<std::uint32_t>("owners", expected.size());
    session.write("mappings", mapping_buffer, mappings);
    session.write("pixels", pixel_buffer, pixels);
    session.fill("owners", results, kPoison);
    auto kernel =
        program.kernel<const Buffer<raya_mapping>&, const Buffer<raya_pixel>&, cl_uint, Buffer<std::uint32_t>&>(
            "find_owners");
    session.launch("find owners", kernel, cases, 1, mapping_buffer, pixel_buffer, static_cast<cl_uint>(cases), results);
    Words got(expected.size());
    session.read("owners", results, got);
    const auto what = [&, &at = mappings, &of = pixels](std::size_t i) {
        return fmt::format("pixel (row {}, column {}) of {}x{} on {} PEs, {}", of[i].row, of[i].column, at[i].width,
                           at[i].height, at[i].pes, mapping_text(at[i]));
    };
    return compare_cases(expected, got,
                         {"owner", "size of the share", "number in the share", "row", "column", "neighbours"},
                         program.options(), what, fmt::format("{} pixels", cases));
}

Verdict check_ways(const Verification& v, Session& session) {
    const std::size_t cases = v.full() ? 50'000 : 5'000;
    const auto [toruses, nodes] = torus_cases(cases);
    Words expected;
    for (std::size_t i = 0; i < cases; ++i) {
        expected.push_back(raya_next_link(toruses[i], nodes[2 * i], nodes[2 * i + 1]));
        expected.push_back(raya_home_link(toruses[i], nodes[2 * i]));
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            expected.push_back(raya_link_end(toruses[i], nodes[2 * i], link));
    }
    const Program program = v.build(session, "verify/machine.cl", {});
    auto torus_buffer = session.buffer<raya_torus>("toruses", cases);
    auto node_buffer = session.buffer<std::uint32_t>("nodes", nodes.size());
    auto results = session.buffer<std::uint32_t>("ways", expected.size());
    session.write("toruses", torus_buffer, toruses);
    session.write("nodes", node_buffer, nodes);
    session.fill("ways", results, kPoison);
    auto kernel =
        program.kernel<const Buffer<raya_torus>&, const Buffer<std::uint32_t>&, cl_uint, Buffer<std::uint32_t>&>(
            "find_ways");
    session.launch("find ways", kernel, cases, 1, torus_buffer, node_buffer, static_cast<cl_uint>(cases), results);
    Words got(expected.size());
    session.read("ways", results, got);
    const auto what = [&, &at = toruses, &of = nodes](std::size_t i) {
        return fmt::format("node {} to {} on {}", of[2 * i], of[2 * i + 1],
                           sides_text({at[i].sides[0], at[i].sides[1], at[i].sides[2]}));
    };
    return compare_cases(expected, got,
                         {"next link", "link home", "end of +x", "of -x", "of +y", "of -y", "of +z", "of -z"},
                         program.options(), what, fmt::format("{} pairs of nodes", cases));
}

Verdict check_local_memory(const Verification& v, Session& session, std::uint32_t group_size) {
    constexpr std::uint32_t kGroups = 64, kTimes = 9;
    if (group_size > v.device().max_group_size)
        return skipped(
            fmt::format("{} work-items wanted, the device has {} in a group", group_size, v.device().max_group_size));
    // 2 x 2000 words are half of the 32 KB that OpenCL promises.
    const std::uint32_t words = 2000;
    const Program program = v.build(session, "verify/machine.cl", {.group_size = group_size});
    Words from(std::size_t{kGroups} * words), expected(from.size()), got(from.size()), drawn(from.size());
    std::iota(from.begin(), from.end(), 0u);
    for (std::size_t i = 0; i < from.size(); ++i)  // an odd number of times: turned round
        expected[i] = from[i / words * words + (words - 1 - i % words)] + kTimes;
    auto from_buffer = session.buffer<std::uint32_t>("from", from.size());
    auto to_buffer = session.buffer<std::uint32_t>("to", from.size());
    auto drawn_buffer = session.buffer<std::uint32_t>("drawn", from.size());
    session.write("from", from_buffer, from);
    session.fill("to", to_buffer, kPoison);
    session.fill("drawn", drawn_buffer, 0);
    using Local = LocalMemory<std::uint32_t>;
    auto kernel = program.kernel<const Buffer<std::uint32_t>&, cl_uint, cl_uint, Local, Local, Buffer<std::uint32_t>&,
                                 Buffer<std::uint32_t>&>("turn_round");
    session.launch("turn round", kernel, kGroups, group_size, from_buffer, words, kTimes, Local{2 * words}, Local{1},
                   to_buffer, drawn_buffer);
    session.read("to", to_buffer, got);
    session.read("drawn", drawn_buffer, drawn);
    const auto what = [&](std::size_t i) { return fmt::format("group {}, word {}", i / words, i % words); };
    const std::string done = fmt::format("{} groups of {} words", kGroups, words);
    const Verdict turned = compare_cases(expected, got, {"local memory"}, program.options(), what, done);
    if (turned.outcome != Outcome::kPass) return turned;
    return compare_cases(Words(drawn.size(), 1), drawn, {"draws of a number from the counter"}, program.options(), what,
                         done);
}

const char* kind_name(std::uint32_t kind) {
    constexpr std::array<const char*, RAYA_RANDOM + 1> kNames = {
        "cyclic, cyclic fold", "cyclic, block fold", "rows", "blocks", "grid", "tiles", "random"};
    return kNames[kind];
}

}  // namespace

void verify_machines(Verification& v) {
    for (std::uint32_t kind = 0; kind <= RAYA_RANDOM; ++kind)
        v.check("machine", fmt::format("mapping: {}", kind_name(kind)),
                [&](Session& session) { return check_owners(v, session, kind); });
    v.check("machine", "ways through the torus", [&](Session& session) { return check_ways(v, session); });
    for (const std::uint32_t group : v.full() ? std::vector{1u, 2u, 8u, 32u, 64u} : std::vector{1u, 32u})
        v.check("machine", fmt::format("local memory and barriers, {} work-item{}", group, group == 1 ? "" : "s"),
                [&](Session& session) { return check_local_memory(v, session, group); });
    verify_transfers(v);
}

}  // namespace raya
