// Tests of random kernels: the interpreter against a C++ compiler, a device against the interpreter, injected faults of
// a compiler, and the reduction of a kernel with a wrong result.
#include <fmt/ranges.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <regex>
#include <sstream>

#include "host/base/encoding.hpp"
#include "host/base/whole_file.hpp"
#include "host/verify/random_kernel.hpp"
#include "host/verify/verify.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/paths.h"

namespace raya {
namespace {

using Change = std::function<std::string(const std::string&)>;

std::vector<Check> run(std::uint32_t kernels, std::uint64_t seed, const Change& change = {}) {
    return verify(choose_device(""), {.seed = seed, .random = kernels, .change_random = change});
}

/// The compiler compiles calls of a function as the macro "NAME(arguments) text" says. Another name stands for it,
/// because implementations define the functions of OpenCL as macros.
Change defines(const std::string& macro) {
    return [macro](const std::string& text) {
        const std::size_t after_prelude = text.find('\n', text.rfind("safe_float16(float16 x)")) + 1;
        const std::regex calls("\\b" + macro.substr(0, macro.find('(')) + "\\(");
        return text.substr(0, after_prelude) + "#define faulty_" + macro + "\n" +
               std::regex_replace(text.substr(after_prelude), calls, "faulty_$&");
    };
}

Change replaces(const std::string& pattern, const std::string& by) {
    return [=](const std::string& text) { return std::regex_replace(text, std::regex(pattern), by); };
}

/// The compiler swaps the operands of integer subtractions.
std::string with_swapped_differences(std::string text) {
    for (std::size_t at = 0; (at = text.find(" - ", at)) != text.npos; ++at) {
        std::size_t begin = at, end = at + 3;
        for (int depth = 0; depth >= 0; --begin) depth += (text[begin - 1] == ')') - (text[begin - 1] == '(');
        for (int depth = 0; depth >= 0; ++end) depth += (text[end] == '(') - (text[end] == ')');
        const std::string left = text.substr(begin + 1, at - begin - 1), right = text.substr(at + 3, end - at - 4);
        if (right.find_first_not_of("0123456789") == right.npos || left.find('\n') != left.npos ||
            left.ends_with("gid"))
            continue;
        text.replace(begin + 1, end - begin - 2, right + " - " + left);
    }
    return text;
}

const std::vector<std::pair<const char*, Change>> kFaults = {
    {"operands of -", with_swapped_differences},
    {"min", defines("min(a, b) max(a, b)")},
    {"hadd rounds up", defines("hadd(a, b) rhadd(a, b)")},
    {"rhadd rounds down", defines("rhadd(a, b) hadd(a, b)")},
    {"add_sat subtracts", defines("add_sat(a, b) sub_sat(a, b)")},
    {"operands of sub_sat", defines("sub_sat(a, b) sub_sat(b, a)")},
    {"operand of mul_hi", defines("mul_hi(a, b) mul_hi(b, b)")},
    {"rotate drops the wrapped bits", defines("rotate(a, b) bitselect(a, rotate(a, b), a)")},
    {"clz", defines("clz(a) popcount(a)")},
    {"popcount", defines("popcount(a) clz(a)")},
    {"abs", defines("abs(a) (a)")},
    {"abs_diff", defines("abs_diff(a, b) abs(a)")},
    {"operands of bitselect", defines("bitselect(a, b, c) bitselect(b, a, c)")},
    {"operands of select", defines("select(a, b, c) select(b, a, c)")},
    {"order of shuffle", defines("shuffle(v, m) shuffle(v, (m) >> 1)")},
    {"all", defines("all(a) any(a)")},
    {"any", defines("any(a) all(a)")},
    {"fma rounds twice", defines("fma(a, b, c) ((a) * (b) + (c))")},
    {"floor", defines("floor(a) ceil(a)")},
    {"ceil", defines("ceil(a) trunc(a)")},
    {"rint", defines("rint(a) floor(a)")},
    {"copysign", defines("copysign(a, b) fabs(a)")},
    {"num_add without rounding", defines("num_add(a, b) ((a) + (b))")},
    {"num_mad rounds twice", defines("num_mad(a, b, c) num_add(num_mul(a, b), c)")},
    {"num_div by the reciprocal", defines("num_div(a, b) num_mul(a, num_div(1.0f, b))")},
    {"conversions that saturate", replaces("convert_(u?char|u?short)_sat\\((?!safe)", "convert_$1(")},
    {"comparison", replaces(" <= (?!\\(float)", " < ")},
    {"mask of a switch", replaces("& 3u\\) \\{", "& 1u) {")},
    {"case falls through", replaces("\n *break;", "")},
    {"continue ends the loop", replaces("\\) continue;", ") break;")},
    {"atomic_xor", replaces("atomic_xor", "atomic_or")},
    {"exchange with another work-item", replaces("\\(lid \\+ (\\d+)u\\)", "(lid + $1u + 1u)")},
    {"order of a swizzle", replaces("\\.s10", ".s01")},
};

}  // namespace

TEST_CASE("random kernels: a C++ compiler computes the interpreter's results", "[verify]") {
    const char* const wanted = std::getenv("RAYA_RANDOM_KERNELS");
    const std::uint64_t seed = 4711, kernels = wanted ? std::stoull(wanted) : 6;
    constexpr std::uint64_t kBatch = 40;
    const ScratchFolder folder;
    for (std::uint64_t first = 0; first < kernels; first += kBatch) {
        std::string text = "#include \"tests/verify/kernel_as_cpp.hpp\"\n", calls, expected;
        for (std::uint64_t n = first; n < std::min(first + kBatch, kernels); ++n) {
            const RandomKernel k = random_kernel(seed, n);
            const std::vector<std::uint32_t> in = random_input(seed, n);
            text += fmt::format("namespace k{} {{\n{}}}\n", n, source_of(k, Dialect::kCpp));
            calls += fmt::format("    run_kernel(k{}::random_kernel, {}, {}, {}, {}, {}, {}, {}, {{{}}});\n", n,
                                 k.groups, k.group_size, k.words_per_item() * k.work_items(), k.element_bytes(),
                                 k.format.exponent_bits, k.format.fraction_bits, int{k.format.truncates},
                                 fmt::join(in, ", "));
            const KernelResults results = interpreted(k, in);
            for (const auto* words : {&results.out, &results.counters})
                for (const std::uint32_t word : *words) expected += fmt::format("{:08x} ", word);
            expected += '\n';
        }
        write_whole_file(folder / "kernels.cpp", text + "int main() {\n" + calls + "}\n");
        REQUIRE(std::system(
                    fmt::format("cd '{0}' && c++ -std=c++20 -O0 -w -ffp-contract=off -I '{1}' kernels.cpp -o kernels "
                                "&& ./kernels > results",
                                folder.path().string(), RAYA_SOURCE_DIR)
                        .c_str()) == 0);
        std::istringstream got(read_file(folder / "results")), right(expected);
        std::string got_line, right_line;
        for (std::uint64_t n = first; std::getline(right, right_line); ++n) {
            INFO("seed " << seed << ", kernel " << n);
            std::getline(got, got_line);
            CHECK(got_line == right_line);
        }
    }
}

TEST_CASE("random kernels: the device computes the interpreter's results", "[verify]") {
    for (const Check& check : run(3, 7)) CHECK_THAT(check_lines(check), Catch::StartsWith("PASS"));
}

TEST_CASE("verify for a time: equal seeds give equal sequences of checks; the first that are done are left out",
          "[verify]") {
    const auto names = [](std::uint64_t seed, std::size_t done) {
        std::vector<std::string> all;
        for (std::uint32_t seconds = 1; all.size() < 4 && seconds < 100;
             seconds *= 2) {  // on a busy computer a check may take a second
            all.clear();
            verify(choose_device(""), {.only = "number", .soak_s = seconds, .seed = seed, .lanes = 4, .done = done},
                   {.finished = [&](const Check& check) { all.push_back(check.name + check.verdict.result); }});
        }
        REQUIRE(all.size() > 3);
        all.resize(4);
        return all;
    };
    const std::vector<std::string> first = names(3, 0), later = names(3, 2);
    CHECK(first != names(4, 0));
    CHECK(std::vector(first.begin() + 2, first.end()) == std::vector(later.begin(), later.begin() + 2));
}

TEST_CASE("random kernels: a kernel is reduced to what fails", "[verify]") {
    const auto selects = [](const RandomKernel& kernel) {
        const std::string text = source_of(kernel, Dialect::kOpenCl);
        return text.find("select(", text.rfind("safe_float16(float16 x)") + 200) != std::string::npos;
    };
    const auto changes = reducing_changes(random_kernel(1, 1), [&](const auto& tried, const RandomKernel& smaller) {
        CHECK(source_of(random_kernel(1, 1, tried), Dialect::kOpenCl) == source_of(smaller, Dialect::kOpenCl));
        CHECK(interpreted(smaller, random_input(1, 1)).counters.size() == kCounters);
        return selects(smaller);
    });
    const RandomKernel kernel = random_kernel(1, 1, changes);
    CHECK(selects(kernel));
    CHECK(size_of(kernel) < 20);
    CHECK(size_of(random_kernel(1, 1)) > 200);
}

TEST_CASE("random kernels detect injected faults of a compiler", "[verify][slow]") {
    std::size_t detected = 0;
    std::string report;
    for (const auto& [name, change] : kFaults) {
        bool found = false;
        int kernels = 0;
        for (std::uint64_t n = 0; n < 60 && !found; ++n, ++kernels) {
            const RandomKernel kernel = random_kernel(1, n);
            const std::string text = source_of(kernel, Dialect::kOpenCl);
            if (change(text) == text) continue;
            Session session(choose_device(""));
            const std::vector<std::uint32_t> in = random_input(1, n);
            found = run_random_kernel(session, kernel, in, {.change_random = change}) != interpreted(kernel, in);
        }
        detected += found;
        report += fmt::format("{:<36} {}\n", name, found ? fmt::format("found by kernel {}", kernels) : "not found");
    }
    WARN(fmt::format("{} of {} faults detected\n{}", detected, kFaults.size(), report));
    CHECK(detected >= kFaults.size() - 2);
}

}  // namespace raya
