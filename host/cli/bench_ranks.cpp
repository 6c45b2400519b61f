#include "host/cli/bench_ranks.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "host/base/progress.hpp"
#include "host/base/say.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/temporary_folder.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "host/model/unit_text.hpp"
#include "host/report/table.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff_writer.hpp"
#include "host/study/measured.hpp"
#include "host/study/other_load.hpp"
#include "host/study/rank_runs.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

using Words = std::vector<std::string>;

// One number of ranks and what they render.
struct RankRow {
    std::string scaling;  // strong: the same picture; weak: work in proportion to ranks
    std::uint32_t ranks = 1;
    bool one_core = false;  // of the one rank
    std::size_t objects = 0;
    std::string first;        // scaling of the rows of one rank that it is held against
    Words arguments{};        // of render
    std::uint32_t units = 0;  // cores, or devices, that the ranks have together
    bool shared = false;      // more ranks than cores
    RankedRender said{};      // of the first render
    std::vector<double> seconds{};

    Measured times() const { return measured_of(seconds); }
    double best_s() const { return 1e-3 * times().min_ms; }
    // Work of a second of one core.
    double rate() const { return said.work / (best_s() * units); }
};
using Rows = std::vector<RankRow>;

// What render is given beside scene and size: all that was given to bench and is not its own.
Words passed_on(const CLI::App& parsed) {
    std::set<std::string> own = {"help", "size", "samples", "report", "ranks", "quiet", "verbose"};
    own.insert(view_option_names().begin(), view_option_names().end());  // in the scene's file
    Words words;
    for (const CLI::Option* option : parsed.get_options()) {
        if (option->count() == 0 || option->get_lnames().empty() || own.contains(option->get_lnames()[0])) continue;
        words.push_back("--" + option->get_lnames()[0]);
        if (option->get_expected_min() > 0) words.push_back(option->results().front());
    }
    return words;
}

Words arguments_of(const std::string& scene, const ImageSize& size, const Words& more) {
    Words words = {scene, "--size", fmt::format("{}x{}", size.width, size.height)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

class RowMaker {
  public:
    RowMaker(const CLI::App& parsed, const RenderOptions& options, const Scene& scene, const TemporaryFolder& folder)
        : more_(passed_on(parsed)),
          size_(image_size(options, scene)),
          objects_(scene.object_count()),
          file_(options.scene),
          torus_(machine_named(options.machine).kind == MachineKind::kTorus),
          folder_(folder) {
        if (!file_.empty() && !is_standard_stream(file_) && !options.view.given()) return;
        file_ = folder / scene.name;
        write_whole_file(file_, write_nff(scene));
    }

    RankRow strong(std::uint32_t ranks) const {
        return {.scaling = "strong",
                .ranks = ranks,
                .objects = objects_,
                .first = "strong",
                .arguments = arguments_of(file_, size_, more_)};
    }

    // On a ring more pixels, on the torus more objects: even spheres, as many for each rank as the scene has objects.
    RankRow weak(std::uint32_t ranks) const {
        RankRow row = strong(ranks);
        row.scaling = "weak";
        if (!torus_) {
            row.arguments = arguments_of(file_, size_for(size_, ranks), more_);
            return row;
        }
        row.first = "weak";
        row.objects = objects_ * ranks;
        const std::string file = folder_ / fmt::format("even-{}.nff", row.objects);
        write_whole_file(file, write_nff(generate_uniform(static_cast<int>(row.objects), {4, 4, 4})));
        row.arguments = arguments_of(file, size_, more_);
        return row;
    }

    bool torus() const { return torus_; }

  private:
    Words more_;
    ImageSize size_;
    std::size_t objects_;
    std::string file_;
    bool torus_;
    const TemporaryFolder& folder_;
};

// Of one rank, too, what the others are held against.
Rows rows_of(const RowMaker& make, std::set<std::uint32_t> ranks) {
    ranks.insert(1);
    Rows rows;
    for (const std::uint32_t count : ranks) rows.push_back(make.strong(count));
    for (const std::uint32_t count : ranks)
        if (count > 1 || make.torus()) rows.push_back(make.weak(count));
    return rows;
}

std::optional<std::uint32_t> threads_of(const RankRow& row) {
    return row.one_core ? std::optional<std::uint32_t>(1) : std::nullopt;
}

// The first render tells the device; on processors one core is measured beside all of them.
void add_rows_of_one_core(Rows& rows) {
    Rows all;
    for (const RankRow& row : rows) {
        if (row.ranks == 1) all.push_back(row);
        if (row.ranks == 1) all.back().one_core = true;
        all.push_back(row);
    }
    rows = std::move(all);
}

void find_units(Rows& rows, const Mpirun& mpirun, bool on_processors) {
    for (RankRow& row : rows) {
        row.units = row.ranks;
        if (!on_processors || row.one_core) continue;
        const std::vector<RankPlace> places =
            row.ranks == 1 ? std::vector{own_place("")} : ping_of(mpirun, row.ranks).ranks;
        row.units = cores_of(places);
        row.shared = share_cores(places);
    }
}

void take_sample(RankRow& row, const Mpirun& mpirun) {
    RankedRender render = render_on_ranks(mpirun, row.ranks, threads_of(row), row.arguments);
    row.seconds.push_back(render.render_s);
    if (row.seconds.size() == 1) row.said = std::move(render);
}

const RankRow& first_of(const Rows& rows, const RankRow& row, bool one_core) {
    return *std::ranges::find_if(rows, [&](const RankRow& other) {
        return other.ranks == 1 && other.one_core == one_core && other.scaling == row.first;
    });
}

void check_images(const Rows& rows) {
    for (const RankRow& row : rows) {
        const RankRow& first = first_of(rows, row, false);
        if (row.scaling == "strong" && row.said.hash != first.said.hash)
            throw DeviceError(fmt::format("{} ranks make another image than one: {} and {}", row.ranks, row.said.hash,
                                          first.said.hash));
    }
}

// A core's work in a second against that of the first row; 1: ranks cost nothing.
double efficiency(const Rows& rows, const RankRow& row, bool one_core) {
    return row.rate() / first_of(rows, row, one_core).rate();
}

bool has_one_core(const Rows& rows) { return rows.front().one_core; }

void print_rows(const Rows& rows) {
    const bool cores = has_one_core(rows);
    std::vector<Words> table = {{"scaling", "ranks", cores ? "cores" : "devices", "size", "objects", "ms best",
                                 "median", "Mrays/s", "efficiency", "of one core", "image"}};
    for (const RankRow& row : rows)
        table.push_back({row.scaling, std::to_string(row.ranks),
                         fmt::format("{}{}", row.units, row.shared ? " shared" : ""),
                         fmt::format("{}x{}", row.said.width, row.said.height), std::to_string(row.objects),
                         fmt::format("{:.1f}", row.times().min_ms), fmt::format("{:.1f}", row.times().median_ms),
                         fmt::format("{:.1f}", 1e-6 * static_cast<double>(row.said.rays) / row.best_s()),
                         fmt::format("{:.3f}", efficiency(rows, row, false)),
                         cores ? fmt::format("{:.3f}", efficiency(rows, row, true)) : "-", row.said.hash.substr(0, 8)});
    fmt::print("{}", text_table(table));
    fmt::print(
        "efficiency: counted work that a {0} does in a second, by the best times, over that of one rank with all "
        "cores{1};\nstrong: the same picture; weak: pixels{2} in proportion to ranks\n",
        cores ? "core" : "device", cores ? ", and of one rank with one core" : "", ", on the torus objects,");
    if (std::ranges::any_of(rows, &RankRow::shared))
        fmt::print("shared: there are more ranks than cores, so that they take turns\n");
}

Json json_of(const Rows& rows, const RankRow& row) {
    return {{"scaling", row.scaling},
            {"ranks", row.ranks},
            {"units", row.units},
            {"shared", row.shared},
            {"one_core", row.one_core},
            {"size", fmt::format("{}x{}", row.said.width, row.said.height)},
            {"objects", row.objects},
            {"rays", row.said.rays},
            {"work", row.said.work},
            {"ms", {{"best", row.times().min_ms}, {"median", row.times().median_ms}}},
            {"samples", row.seconds.size()},
            {"efficiency", efficiency(rows, row, false)},
            {"efficiency_of_one_core",
             has_one_core(rows) ? std::optional(efficiency(rows, row, true)) : std::optional<double>()},
            {"hash", row.said.hash}};
}

void print_others(const std::optional<double>& share) {
    if (share && *share > kQuiet)
        fmt::print(
            "other programs had {:.0f} % of this host's processors meanwhile: ranks waited for one another, and "
            "these times say little\n",
            100 * *share);
}

Json report_of(const Rows& rows, const std::string& scene, const std::string& machine,
               const std::optional<double>& others) {
    Json list = Json::list();
    for (const RankRow& row : rows) list.push_back(json_of(rows, row));
    return {{"kind", "raya bench --ranks"},
            {"raya", raya_version()},
            {"scene", scene},
            {"machine", machine},
            {"device", rows.front().said.device},
            {"unit", has_one_core(rows) ? "core" : "device"},
            {"others", others},
            {"rows", list}};
}

std::set<std::uint32_t> checked(const BenchRanks& asked) {
    constexpr std::uint32_t kMost = 65'536;
    for (const std::uint32_t ranks : asked.ranks)
        if (ranks < 1 || ranks > kMost) throw UserError(fmt::format("--ranks {}: must be 1..{}", ranks, kMost));
    return {asked.ranks.begin(), asked.ranks.end()};
}

}  // namespace

ImageSize size_for(const ImageSize& one, std::uint32_t ranks) {
    const auto side = [&](std::uint32_t pixels) {
        return static_cast<std::uint32_t>(std::lround(pixels * std::sqrt(static_cast<double>(ranks))));
    };
    return {side(one.width), side(one.height)};
}

void bench_on_ranks(const CLI::App& parsed, const RenderOptions& options, const Scene& scene, const BenchRanks& asked) {
    const std::set<std::uint32_t> ranks = checked(asked);
    const Mpirun mpirun = Mpirun::of_this_program();
    if (const std::string lack = mpirun.lack(); !lack.empty()) throw UserError("--ranks: " + lack);
    const TemporaryFolder folder("raya-bench");
    std::optional<ProgressBar> bar(std::in_place, true, "preparing");
    Rows rows = rows_of(RowMaker(parsed, options, scene, folder), ranks);
    const RankedRender warm = render_on_ranks(mpirun, 1, {}, rows.front().arguments);  // builds kernels, not counted
    if (warm.on_processors()) add_rows_of_one_core(rows);
    find_units(rows, mpirun, warm.on_processors());
    bar->stage("taking samples");
    const OtherLoad load;
    for (std::uint32_t turn = 0; turn < asked.samples; ++turn)  // in turn, so that a disturbance hits all alike
        for (RankRow& row : rows) {
            take_sample(row, mpirun);
            bar->update((turn + double(&row - rows.data() + 1) / double(rows.size())) / asked.samples);
        }
    const std::optional<double> others = load.share();
    bar.reset();
    check_images(rows);
    fmt::print("{} on {}: {}; {} of each row after a warm-up, in turn\n", printable(scene.name), warm.device,
               options.machine, counted(asked.samples, "render"));
    print_rows(rows);
    print_others(others);
    if (!asked.report.empty())
        write_whole_file(asked.report, report_of(rows, scene.name, options.machine, others).dump(2) + "\n");
}

}  // namespace raya
