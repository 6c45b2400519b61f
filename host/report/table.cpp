#include "host/report/table.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

namespace raya {
namespace {

bool is_number(const std::string& cell) {
    return cell == "-" || (!cell.empty() && std::isdigit(static_cast<unsigned char>(cell.front())));
}

// Returns true if all cells of the column, except the header, are numbers or "-".
bool is_right_aligned(const std::vector<std::vector<std::string>>& rows, std::size_t column) {
    return std::all_of(rows.begin() + 1, rows.end(),
                       [&](const auto& row) { return column >= row.size() || is_number(row[column]); });
}

std::string build_line(double build_s, const std::vector<ProgramBuild>& builds) {
    std::string text = fmt::format("kernel build {:.3f} s, not among the commands", build_s);
    for (std::size_t i = 0; i < builds.size(); ++i)
        text += fmt::format("{} {} {:.3f} s", i == 0 ? ":" : ",", builds[i].name, builds[i].seconds);
    return text +
           (builds.empty() ? "\n" : "; the remainder is the time of first launches, in which some drivers compile\n");
}

}  // namespace

std::string text_table(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i > 0) line += "  ";
            line += is_right_aligned(rows, i) ? fmt::format("{:>{}}", row[i], widths[i])
                                              : fmt::format("{:<{}}", row[i], widths[i]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    }
    return text;
}

std::string profile_table(double build_s, const std::vector<ProgramBuild>& builds,
                          const std::vector<LabelSummary>& commands) {
    const auto number = [](std::uint64_t count) { return static_cast<double>(count); };
    const auto ms = [](double ns) { return fmt::format("{:.3f}", ns * 1e-6); };
    double total_ns = 0;  // total time of all commands
    for (const LabelSummary& c : commands) total_ns += number(c.total_ns);
    std::vector<std::vector<std::string>> rows = {{"label", "kind", "launches", "total ms", "share %", "min ms",
                                                   "mean ms", "max ms", "queue->submit ms", "submit->start ms", "MB",
                                                   "GB/s"}};
    for (const LabelSummary& c : commands) {
        const double total = number(c.total_ns);
        rows.push_back({c.label, c.kind, std::to_string(c.launches), ms(total),
                        fmt::format("{:.1f}", total_ns > 0 ? 100 * total / total_ns : 0), ms(number(c.min_ns)),
                        ms(c.mean_ns), ms(number(c.max_ns)), ms(number(c.submit_ns) / number(c.launches)),
                        ms(number(c.start_ns) / number(c.launches)),
                        c.bytes > 0 ? fmt::format("{:.3f}", 1e-6 * number(c.bytes)) : "-",
                        c.bytes > 0 && c.total_ns > 0 ? fmt::format("{:.3f}", number(c.bytes) / total) : "-"});
    }
    return build_line(build_s, builds) + text_table(rows);
}

}  // namespace raya
