#include "host/cli/bench_tables.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <set>

#include "host/base/say.hpp"
#include "host/cl/operation_rates.hpp"
#include "host/report/table.hpp"

namespace raya {
namespace {

// The first row of the same lanes: what the slow-down of a format is measured against.
const BenchRow& first_of_lanes(const std::vector<BenchRow>& rows, const BenchRow& row) {
    return *std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) {
        return r.said.kernel == row.said.kernel && r.said.lanes == row.said.lanes;
    });
}

}  // namespace

void print_rows(const std::vector<BenchRow>& rows) {
    std::vector<std::vector<std::string>> table = {{"kernel", "format", "lanes", "group", "Mrays/s best", "median",
                                                    "ms best", "median", "speed-up", "slow-down", "build s", "pixels"}};
    for (const BenchRow& row : rows) {
        const auto rays = static_cast<double>(row.said.rays) * 1e-6;
        table.push_back({row.said.kernel, row.said.format, std::to_string(row.said.lanes),
                         std::to_string(row.said.group_size), fmt::format("{:.1f}", rays / row.best()),
                         fmt::format("{:.1f}", rays / row.median()), fmt::format("{:.2f}", 1e3 * row.best()),
                         fmt::format("{:.2f}", 1e3 * row.median()),
                         fmt::format("{:.2f}", first_of_format(rows, row).median() / row.median()),
                         fmt::format("{:.2f}", row.median() / first_of_lanes(rows, row).median()),
                         fmt::format("{:.2f}", row.build_s), row.said.hash.substr(0, 8)});
    }
    fmt::print("{}", text_table(table));
    fmt::print(
        "speed-up: over the first row of the same format; slow-down: against the first row of the same kernel and "
        "lanes (medians);\n"
        "pixels: hash of the image, checked to be the same in all rows of a format\n");
}

void print_operations(Session& session, const std::vector<NumberFormat>& formats, std::uint32_t lanes, int samples) {
    std::vector<std::vector<std::string>> table = {{"Gop/s", "lanes"}};
    table[0].insert(table[0].end(), kOperations.begin(), kOperations.end());
    std::array<double, kOperations.size()> first{};
    for (const NumberFormat& format : formats) {
        OperationRates operations(session, format, lanes);
        std::array<double, kOperations.size()> rates{};
        for (std::size_t kind = 0; kind < rates.size(); ++kind) rates[kind] = operations.measure(kind, samples);
        if (table.size() == 1) first = rates;
        table.push_back({format_name(format), std::to_string(lanes)});
        for (std::size_t i = 0; i < rates.size(); ++i)
            table.back().push_back(
                fmt::format("{:.2f} ({:.1f} x)", rates[i] * 1e-9, rates[i] > 0 ? first[i] / rates[i] : 0));
    }
    fmt::print("\noperations of the number layer, best of {}; in brackets the time against {}\n{}", samples,
               format_name(formats.front()), text_table(table));
}

void print_tuned(const std::vector<BenchRow>& rows) {
    std::set<std::string> files;
    for (const BenchRow& row : rows)
        if (row.tuned != "defaults" && row.tuned != "options") files.insert(row.tuned);
    for (const std::string& file : files) fmt::print("tuned: {}\n", printable(file));
}

void print_denormals(const std::vector<BenchRow>& rows) {
    std::vector<std::vector<std::string>> table = {
        {"kernel", "format", "lanes", "ms best", "flushed", "ratio", "median", "flushed", "ratio"}};
    for (const BenchRow& row : rows)
        for (const BenchRow& other : rows) {
            const bool pair = other.flushed && other.said.kernel == row.said.kernel + ", flushed" &&
                              other.said.format == row.said.format && other.said.lanes == row.said.lanes;
            if (!pair) continue;
            const auto ms = [](double s) { return fmt::format("{:.2f}", 1e3 * s); };
            table.push_back({row.said.kernel, row.said.format, std::to_string(row.said.lanes), ms(row.best()),
                             ms(other.best()), fmt::format("{:.2f}", row.best() / other.best()), ms(row.median()),
                             ms(other.median()), fmt::format("{:.2f}", row.median() / other.median())});
        }
    fmt::print("\nwith denormal numbers, and with -cl-denorms-are-zero; above 1: lanes compute with them\n{}",
               text_table(table));
}

}  // namespace raya
