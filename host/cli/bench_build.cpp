#include "host/cli/bench_build.hpp"

#include <fmt/core.h>

#include "host/base/clock.hpp"
#include "host/cli/bench_rows.hpp"
#include "host/report/table.hpp"

namespace raya {
namespace {

std::string seconds_text(double s) { return fmt::format("{:.2f}", s); }

}  // namespace

std::vector<BenchBuild> bench_builds(Session& session, const Scene& scene, RingSettings settings,
                                     const std::vector<NumberFormat>& formats,
                                     const std::vector<std::string>& variants) {
    // Drivers cache kernels by source and options. No earlier build has this option, so the driver compiles anew.
    const std::string unique_option = fmt::format("-DRAYA_BUILT={}", Clock::now().time_since_epoch().count());
    settings.kernels.sources.more_options.push_back(unique_option);
    KernelBuilds recorded;
    session.observe(recorded);
    std::vector<BenchBuild> builds;
    for (const NumberFormat& format : formats) {
        for (const std::string& variant : variants) {
            RingSettings variant_settings = settings;
            std::uint32_t lanes = render_row(session, scene, variant_settings, format, variant).result.lanes;
            if (variant != "torus" && variant == variants.front() && !variant_settings.dynamic)
                for (const AntialiasMethod method : {AntialiasMethod::kFilter, AntialiasMethod::kSupersample}) {
                    variant_settings.antialias.method = method;
                    lanes = render_row(session, scene, variant_settings, format, variant).result.lanes;
                }
            for (KernelBuild& build : recorded.all) {
                std::string& options = build.options;
                if (const auto position = options.find(unique_option); position != options.npos)
                    options.erase(position > 0 ? position - 1 : position,
                                  unique_option.size() + (position > 0 ? 1 : 0));
                builds.push_back({.kernel = build.name,
                                  .variant = variant,
                                  .format = format_name(format),
                                  .lanes = lanes,
                                  .build_s = build.build_s,
                                  .launch_s = build.launch_s,
                                  .build_options = options});
            }
            recorded.all.clear();
        }
    }
    session.ignore(recorded);
    return builds;
}

void print_builds(const std::vector<BenchBuild>& builds) {
    std::vector<std::vector<std::string>> table = {
        {"kernel", "variant", "format", "lanes", "build s", "first launch s"}};
    double build_s = 0, launch_s = 0;
    for (const BenchBuild& build : builds) {
        table.push_back({build.kernel, build.variant, build.format, std::to_string(build.lanes),
                         seconds_text(build.build_s), seconds_text(build.launch_s)});
        build_s += build.build_s;
        launch_s += build.launch_s;
    }
    fmt::print("{}first launch: includes the compilation that the driver defers until the first launch\n",
               text_table(table));
    fmt::print("total: {} s of builds, {} s of first launches\n", seconds_text(build_s), seconds_text(launch_s));
}

}  // namespace raya
