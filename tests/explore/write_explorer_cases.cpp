// explorer_cases FOLDER SEED COUNT: pages of the explorer over made-up costs, PAGE.html, and what each must say in
// COUNT settings, PAGE.json, by the program's own functions; what tests/tools/test_explore.py holds them to in a
// browser.
#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>

#include "host/base/json.hpp"
#include "host/base/whole_file.hpp"
#include "host/explore/explorer.hpp"
#include "host/explore/figures.hpp"
#include "host/ring/schedule.hpp"
#include "tests/explore/random_settings.hpp"

namespace {

using namespace raya;

struct PageCase {
    const char* name;
    std::uint32_t width, height;
    int bits;
    const char* machine;
};

constexpr PageCase kPages[] = {
    {"square", 64, 64, 17, "spa"},  {"odd", 37, 23, 12, "grande"}, {"wide", 96, 20, 20, "spa"},
    {"line", 13, 1, 9, "spa"},      {"column", 1, 9, 9, "spa"},    {"pixel", 1, 1, 9, "spa"},
    {"large", 160, 144, 33, "spa"}, {"huge", 16, 16, 45, "spa"},   {"nothing", 12, 8, 0, "spa"}};

// As the page's link has it.
std::string link_of(const raya_mapping& m) {
    return fmt::format("mapping={}&pes={}{}", mapping_text(m), m.pes, m.kind == RAYA_FOLD_BLOCK ? "&fold=block" : "");
}

Json case_of(const CostImage& cost, const raya_mapping& m, const Machine& machine, bool whole) {
    const ExplorerFigures f = figures_of(cost, m, machine);
    Json texts = Json::object();
    for (const auto& [name, text] : figure_texts(f)) texts[name] = text;
    Json one = {{"link", link_of(m)}, {"texts", texts}, {"imbalance", f.load.imbalance}, {"pes", m.pes}};
    if (!whole) return one;
    one["loads"] = f.load.per_pe;
    std::vector<std::uint32_t> offsets(m.width);
    std::iota(offsets.begin(), offsets.end(), 0u);
    one["cyclic"] = imbalance_of_offsets(cost, m.pes, RAYA_FOLD_CYCLIC, offsets);
    one["block"] = imbalance_of_offsets(cost, m.pes, RAYA_FOLD_BLOCK, offsets);
    return one;
}

// Numbers as fmt prints them; halves of the last digit among them.
Json numbers_of(RandomSettings& random) {
    Json numbers = Json::list();
    for (int i = 0; i < 400; ++i) {
        const int digits = 1 + i % 3;
        const double value = i % 2 ? std::ldexp(random.below(1u << 20), -static_cast<int>(random.below(12)))
                                   : random.below(1u << 30) / static_cast<double>(random.from(1, 100000));
        numbers.push_back(Json{{"value", value}, {"digits", digits}, {"text", fmt::format("{:.{}f}", value, digits)}});
    }
    return numbers;
}

void write_page(const std::filesystem::path& folder, const PageCase& page, RandomSettings& random, int count) {
    CostImage cost = random.costs(page.width, page.height, page.bits);
    // The most that a page takes: 2^53 - 1 in all.
    if (page.bits == 45) cost.cycles.back() += (std::uint64_t{1} << 53) - 1 - total_cycles(cost);
    Image image{static_cast<int>(page.width), static_cast<int>(page.height), {}};
    for (std::size_t i = 0; i < 3 * cost.cycles.size(); ++i) image.rgb.push_back(static_cast<float>(i % 7) / 6);
    const Machine& machine = machine_named(page.machine);
    const raya_mapping opens = random.mapping(page.width, page.height);
    Json cases = Json::list();
    cases.push_back(case_of(cost, opens, machine, true));  // without scripts, too
    for (int i = 1; i < count; ++i)
        cases.push_back(
            case_of(cost, random.mapping(page.width, page.height), machine, i % 8 == 0 && page.width < 100));
    const std::string name = page.name;
    write_whole_file(folder / (name + ".html"),
                     explorer_html({.scene = "<script>planted()</script>{{costs}}'\" " + name + ".nff",
                                    .command = "raya render '<script>planted()</script>' -o image.png",
                                    .settings = "made up",
                                    .made = "Made by a test.",
                                    .machine = machine,
                                    .mapping = opens,
                                    .cost = std::move(cost),
                                    .image = std::move(image)}));
    write_whole_file(folder / (name + ".json"), Json{{"cases", cases}, {"numbers", numbers_of(random)}}.dump());
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 4) return 2;
    RandomSettings random(std::strtoull(arguments[2], nullptr, 10));
    for (const PageCase& page : kPages) write_page(arguments[1], page, random, std::atoi(arguments[3]));
}
