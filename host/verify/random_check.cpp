// Checks of random kernels (random_kernel.hpp) on a device.
#include <fmt/core.h>

#include "host/cl/kernel_options.hpp"
#include "host/error.hpp"
#include "host/verify/random_kernel.hpp"
#include "host/verify/verify.hpp"

namespace raya {

KernelResults run_random_kernel(Session& session, const RandomKernel& kernel, const std::vector<std::uint32_t>& in,
                                const VerifySettings& settings) {
    std::string text = source_of(kernel, Dialect::kOpenCl);
    if (settings.change_random) text = settings.change_random(text);
    const DeviceInfo& device = session.device();
    KernelSources sources = settings.sources;
    sources.more_options.emplace_back("-w");  // no warnings
    const KernelOptions options{.format = kernel.format,
                                .exact_divide = device.correctly_rounded_divide_sqrt,
                                .exact_fma = device.fused_multiply_add};
    CheckRunner runner(session, Kernels(session, options, sources).build("random kernel", text));
    const auto input = runner.filled("in", in);
    auto out = runner.poisoned("out", kernel.words_per_item() * kernel.work_items());
    auto counters = runner.constant("counters", kCounters, std::uint32_t{0});
    auto elements = runner.constant("elements", kernel.element_bytes() + 1, cl_uchar{0});
    runner.run<const Buffer<std::uint32_t>&, Buffer<std::uint32_t>&, Buffer<std::uint32_t>&, Buffer<cl_uchar>&>(
        "random_kernel", kernel.groups, kernel.group_size, input, out, counters, elements);
    return {runner.read(out), runner.read(counters)};
}

namespace {

Verdict wrong_kernel(const RandomKernel& kernel, const std::string& name, const KernelResults& expected,
                     const KernelResults& got) {
    Fault fault{.where = "a counter"};
    const auto [right, wrong] = std::ranges::mismatch(expected.out, got.out);
    if (right != expected.out.end()) {
        const auto at = static_cast<std::size_t>(right - expected.out.begin());
        const std::size_t words = kernel.words_per_item();
        fault = {.where = fmt::format("{} of work-item {}, groups of {}", word_name(kernel, at % words), at / words,
                                      kernel.group_size),
                 .expected = fmt::format("0x{:08x}", *right),
                 .got = fmt::format("0x{:08x}", *wrong)};
    }
    return failed(name + ": wrong", fault);
}

/// Adds the number of compared words to `words`.
Verdict check_random_kernel(Session& session, std::uint64_t number, const VerifySettings& settings,
                            std::size_t& words) {
    const RandomKernel kernel = random_kernel(settings.seed, number, settings.random_changes);
    const std::vector<std::uint32_t> in = random_input(settings.seed, number);
    const KernelResults expected = interpreted(kernel, in);
    const std::string name = fmt::format("kernel {}", number);
    words += expected.out.size() + expected.counters.size();
    try {
        const KernelResults got = run_random_kernel(session, kernel, in, settings);
        report_expected("out", KnownWords(expected.out));
        return got == expected ? passed("") : wrong_kernel(kernel, name, expected, got);
    } catch (const DeviceError& error) {
        throw DeviceError(fmt::format("{}: {}", name, error.what()));
    }
}

}  // namespace

void verify_random(Verification& v) {
    const VerifySettings& settings = v.settings();
    for (std::uint64_t first = settings.random_first; first < settings.random; first += kRandomBatch) {
        const std::uint64_t end = std::min<std::uint64_t>(first + kRandomBatch, settings.random);
        v.check("random", fmt::format("seed_{}_kernels_{}_to_{}", settings.seed, first, end - 1),
                [&](Session& session) {
                    std::size_t words = 0;
                    for (std::uint64_t number = first; number < end; ++number) {
                        const Verdict verdict = check_random_kernel(session, number, settings, words);
                        if (verdict.outcome != Outcome::kPass) return verdict;
                    }
                    return passed(fmt::format("{} words", words));
                });
    }
}

}  // namespace raya
