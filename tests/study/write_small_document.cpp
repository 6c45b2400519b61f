// small_document FOLDER: the files of two made-up pages, with names that would be scripts if they were not text; what
// tests/tools/test_document.py looks at in a browser.
#include <cmath>
#include <cstdio>
#include <vector>

#include "host/study/document.hpp"
#include "host/study/page_writer.hpp"
#include "tests/study/small_page.hpp"

namespace {

const std::string kPlanted = "<script>document.title = 'planted'</script><img src=x onerror='planted()'>.nff";

// Every colour, style and kind of axis, a band and bars.
raya::StudyPage large_page() {
    using raya::PlotStyle;
    raya::StudyPage page;
    page.name = "large";
    page.title = "A study of " + kPlanted;
    page.question = "What does `" + kPlanted + "` show?";
    page.settings = {{"scene", kPlanted}, {"seeds", std::vector{1, 2, 3}}};
    page.run = {"1.2.3", "raya study large '" + kPlanted + "' -o DIR", "a device", "a platform", "4.5"};
    page.claims = {{"C 1999", "section 2", "Never.", raya::ClaimVerdict::kNotReproduced, "Once it was."}};
    raya::StudyTable table{"large", "All rows", {{"n"}, {kPlanted}}};
    for (int i = 0; i < 500; ++i) table.rows.push_back({(i * 37) % 500, kPlanted});
    page.tables = {table};
    for (int i = 0; i < 4; ++i) {
        raya::StudyPlot plot{"large-" + std::to_string(i), "Plot " + std::to_string(i) + kPlanted, "x", "y (ms)",
                             static_cast<raya::Axes>(i)};
        for (int s = 0; s < 11; ++s) {
            raya::PlotSeries series{s == 0 ? kPlanted : "series " + std::to_string(s),
                                    {},
                                    {},
                                    s < 7 ? PlotStyle::kLine : PlotStyle::kPaper};
            for (int x = 1; x < (s == 1 ? 60 : 5); ++x) {
                series.x.push_back(x);
                series.y.push_back(std::exp(0.1 * x) + s);
                if (s < 3) series.half_widths.push_back(0.4 * x);
            }
            plot.series.push_back(series);
        }
        page.plots.push_back(plot);
    }
    return page;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) return 2;
    const std::vector<raya::StudyPage> pages = {raya::small_page(), large_page()};
    std::vector<raya::PlotOutcome> plots;
    for (const raya::StudyPage& page : pages) {
        plots.push_back(raya::write_page(arguments[1], page));
        if (!plots.back().drawn) std::fprintf(stderr, "small_document: not drawn: %s\n", plots.back().reason.c_str());
    }
    raya::write_document(arguments[1], pages, plots);
}
