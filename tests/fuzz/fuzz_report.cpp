// Fuzz target for reports as `raya page` and `raya bench --compare` read them: the commands must either read a report
// or reject it with an error.
#include <cmath>
#include <utility>

#include "host/cli/page.hpp"
#include "host/error.hpp"
#include "host/report/bench_report.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace raya;
using namespace raya::fuzz;

void check_page(std::string_view text) try {
    const std::string page = page_of_report(std::string(text), "report.json");
    if (!page.ends_with("</html>\n")) report_finding("an incomplete page", page.substr(0, 200));
} catch (const UserError& error) {
    check_refusal(error.what(), "report.json");
}

/// Checks that a comparison reports another device, another image and lower rates.
void check_other_run(const BenchReport& report, BenchReport now) {
    BenchMeasurement& row = now.rows.front();
    now.device.name += "x";
    row.hash += "x";
    BenchComparison comparison = compare_bench(report, now, 1e-6);
    if (comparison.remarks.size() != 1 || comparison.other_images != 1)
        report_finding("another device or image is not reported", comparison.text);
    row.hash = report.rows.front().hash;
    row.best_s *= 2, row.median_s *= 2;
    comparison = compare_bench(report, now, 1e-6);
    if (std::isnormal(row.best_rate()) && std::isnormal(row.median_rate()) && comparison.slower != 1)
        report_finding("lower rates are not reported", comparison.text);
    using Runs = std::pair<const BenchReport*, const BenchReport*>;
    row.best_s /= 4, row.median_s /= 4;
    now.rows.push_back(row);
    now.rows.back().kernel += "x";
    for (const auto& [before, after] : {Runs{&report, &now}, Runs{&now, &report}}) {
        comparison = compare_bench(*before, *after, 1e-6);
        if (comparison.compared != static_cast<int>(report.rows.size()))
            report_finding("a new row or a missing one is compared", comparison.text);
        for (const ComparedRow& compared : comparison.rows)
            if (to_json(compared)["verdict"] != compared.verdict)
                report_finding("a row has no verdict", comparison.text);
    }
    if (rows_in_common(report, now) != static_cast<int>(report.rows.size()))
        report_finding("a row is not found in its own report", comparison.text);
}

void check_bench(const ScratchFolder& folder, std::string_view text) {
    const std::string file = folder.write("bench.json", text);
    try {
        BenchReport report = read_bench_report(file);
        // The reader skips these parts of a report.
        report.rows.front().roofline.emplace().unavailable = "not measured";
        report.builds.emplace_back();
        const std::string written = to_json(report).dump();
        const BenchReport reread = read_bench_report(folder.write("again.json", written));
        // Removes the skipped parts from the expected report. Times are stored in milliseconds, so rounding may shorten
        // the text.
        report.rows.front().roofline.reset();
        report.builds.clear();
        if (to_json(read_bench_report(folder.write("again.json", to_json(reread).dump()))).dump().size() + 64 <
            to_json(report).dump().size())
            report_finding("a bench report is shorter after it is written and read again", written);
        const BenchComparison comparison = compare_bench(report, reread, 1e-6);
        if (comparison.slower != 0 || comparison.other_images != 0)
            report_finding("a bench report differs from its own copy", comparison.text);
        check_other_run(report, reread);
    } catch (const UserError& error) {
        check_refusal(error.what(), file);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const ScratchFolder folder;
    check_page(text_of(data, size));
    check_bench(folder, text_of(data, size));
    return 0;
}
