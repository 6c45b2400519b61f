#include "host/verify/soak.hpp"

#include <fmt/core.h>

#include "host/model/unit_text.hpp"

namespace raya {
namespace {

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string first_wrong(const Verdict& verdict) {
    const Fault& f = verdict.fault;
    if (f.where.empty() || f.got.empty()) return first_line(verdict.result);
    return fmt::format("{}: expected {}, got {}", first_line(f.where), first_line(f.expected), first_line(f.got));
}

}  // namespace

std::string SoakCounts::add(const Check& check, double seconds) {
    Count& count = counts_[check.layer + " " + check.name];
    ++count.runs;
    const Outcome outcome = check.verdict.outcome;
    if (outcome != Outcome::kFail && outcome != Outcome::kUnexpectedPass) return "";
    const std::string wrong = first_wrong(check.verdict);
    if (count.failures++ == 0) {
        count.first_s = seconds;
        count.first_wrong = wrong;
    }
    count.repeats += wrong == count.first_wrong;
    const std::string lines = check_lines(check);
    return fmt::format("after {:.1f} s: {}", seconds, count.failures == 1 ? lines : first_line(lines) + "\n");
}

std::string SoakCounts::summary() const {
    std::string lines;
    for (const auto& [name, count] : counts_)
        if (count.failures > 0)
            lines +=
                fmt::format("{}: failed {} of {}, first after {:.1f} s; {} of {} with the same first wrong word: {}\n",
                            name, count.failures, counted(count.runs, "time"), count.first_s, count.repeats,
                            counted(count.failures, "failure"), count.first_wrong);
    return lines;
}

}  // namespace raya
