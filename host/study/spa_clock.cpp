#include "host/study/spa_clock.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "host/model/budget.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/paper.hpp"

namespace raya {
namespace {

constexpr double kPrintedTo = 0.5;  // ms: the tables hold whole ones

Interval rounded(double printed) { return {printed - kPrintedTo, printed + kPrintedTo}; }

}  // namespace

MachineFactor machine_factor() {
    // 9 - 2 and 19 - 12 ms: each of the four is rounded, and both differences are met.
    constexpr double kRounding = 2 * kPrintedTo;
    const double budget_ms = spa_ms(static_cast<double>(filter_cycles(static_cast<std::uint64_t>(paper::kSize))));
    return {paper::kFilterArithmeticMs / budget_ms, (paper::kFilterArithmeticMs - kRounding) / budget_ms,
            (paper::kFilterArithmeticMs + kRounding) / budget_ms};
}

std::string clock_text() {
    const MachineFactor factor = machine_factor();
    return fmt::format(
        "modelled, one clock: the budget's cycles of 100 ns times {:.2f} ({:.2f} .. {:.2f} by rounding), which is the "
        "filter's factor, 7 ms [D] over what the budget gives it and of no scene; rotations, exchanges and transfers "
        "at the rates of the real machine. Nothing is fitted to a scene. That the factor holds for ray tracing too is "
        "an assumption: conclusions are shown for factors of 1 to 8.",
        factor.value, factor.least, factor.most);
}

Interval HostModel::call_ms(double words) const {
    return {setup_ms.least + 1e3 * words / words_per_s.most, setup_ms.most + 1e3 * words / words_per_s.least};
}

HostModel host_model() {
    constexpr double kFew = 2, kMany = 34;  // rotations of p = 0 and p = 16
    const Interval few = rounded(paper::kExchange0Ms), many = rounded(paper::kExchange16Ms),
                   image = rounded(paper::kImageMs);
    const double words = 3 * paper::kSize * paper::kSize;
    HostModel model{};
    model.rotation_ms = {(many.least - few.most) / (kMany - kFew), (many.most - few.least) / (kMany - kFew)};
    // few = setup + 2 r and many = setup + 34 r give setup = (34 few - 2 many) / 32.
    model.setup_ms = {(kMany * few.least - kFew * many.most) / (kMany - kFew),
                      (kMany * few.most - kFew * many.least) / (kMany - kFew)};
    model.words_per_s = {1e3 * words / (image.most - model.setup_ms.least),
                         1e3 * words / (image.least - model.setup_ms.most)};
    return model;
}

}  // namespace raya
