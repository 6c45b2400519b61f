// What the machines rest on beside numbers: whole-number arithmetic in kernels, local memory and barriers, and copies
// between buffers. All of it is exact.
#include "host/checks/machines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "host/checks/transfers.hpp"
#include "host/machine/unit_text.hpp"
#include "host/ring/mapping.hpp"
#include "host/torus/topology.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

std::vector<std::string> compiler_at_fault() {
    return {
        "the compiler is wrong about whole numbers or barriers, not about fp32: look for a switch of the driver that\n"
        "turns its optimiser off, and tell its makers",
        "a newer driver, or another OpenCL implementation for this device (raya devices)"};
}

std::vector<std::string> driver_at_fault() {
    return {
        "a newer driver: copies between buffers on the device are wrong, or not in the order in which they were given",
        "another OpenCL implementation for this device (raya devices)"};
}

const char* kind_name(std::uint32_t kind) {
    constexpr std::array<const char*, RAYA_RANDOM + 1> kNames = {
        "cyclic, cyclic fold", "cyclic, block fold", "rows", "blocks", "grid", "tiles", "random"};
    return kNames[kind];
}

void verify_kernels(Verification& v) {
    const std::size_t cases = v.full() ? 50'000 : 5'000;
    const auto check = [&](const std::string& name, std::uint32_t group,
                           const std::function<Verdict(CheckRunner&)>& body) {
        v.check("machine", name, [&](Session& session) {
            if (group > v.device().max_group_size)
                return skipped(fmt::format("{} work-items wanted, the device has {} in a group", group,
                                           v.device().max_group_size));
            CheckRunner runner = machine_runner(session, v.sources(), group);
            return with_remedies(body(runner), runner.options(), compiler_at_fault());
        });
    };
    for (std::uint32_t kind = 0; kind <= RAYA_RANDOM; ++kind)
        check(fmt::format("mapping: {}", kind_name(kind)), 1,
              [&](CheckRunner& runner) { return check_owners(runner, kind, cases); });
    check("ways through the torus", 1, [&](CheckRunner& runner) { return check_ways(runner, cases); });
    for (const std::uint32_t group : v.full() ? std::vector{1u, 2u, 8u, 32u, 64u} : std::vector{1u, 32u})
        check("local memory and barriers, " + counted(group, "work-item"), group,
              [&](CheckRunner& runner) { return check_local_memory(runner, group); });
}

void verify_transfers(Verification& v) {
    const auto check = [&](const std::string& name, const std::function<Verdict(Session&)>& body) {
        v.check("machine", name, [&](Session& session) { return with_remedies(body(session), "", driver_at_fault()); });
    };
    const std::vector<BlockCopy> copies = {{{3, 17, 0}, {0, 5, 2}, 5, 40},
                                           {{0, 8, 1}, {4, 31, 0}, 8, 33},
                                           {{2, 9, 5}, {1, 7, 3}, 4, 300},
                                           {{0, 64, 0}, {0, 64, 64}, 64, 63}};
    check("copies of blocks", [&](Session& s) { return check_copies(s, copies); });
    check("bus: broadcast and gather", [](Session& s) { return check_bus(s); });
    check("bus: transfers between 31 PEs", [](Session& s) { return check_transfers(s, 31, 100); });
    using Sizes = std::pair<std::size_t, std::size_t>;
    for (const auto& [pes, words] : {Sizes{2, 1}, {7, 100}, {256, 768}})
        check(fmt::format("ring: rotations of {} PEs", pes),
              [p = pes, w = words](Session& s) { return check_rotations(s, p, w); });
    for (const Links links : {Links::kTorus3d, Links::kTorus2d})
        for (const std::uint32_t every : {1u, 50u}) {
            const std::string name =
                fmt::format("{}: exchange of {}", links_name(links), every == 1 ? "all boxes" : "few boxes");
            const raya_torus torus = make_torus({3, 2, 4}, links);
            check(name, [&](Session& s) { return check_links(s, torus, every); });
            v.check("machine", name + " by a kernel", [&](Session& s) {
                // Boxes of up to 12 units of 8 words: some work-items have one, some none.
                Kernels kernels(s, {.group_size = std::min(8u, most_group_size(v.device()))}, v.sources());
                return with_remedies(check_links(s, torus, every, &kernels), "", compiler_at_fault());
            });
        }
}

}  // namespace

void verify_machines(Verification& v) {
    verify_kernels(v);
    verify_transfers(v);
}

}  // namespace raya
