// raya bench --ranks: the same picture, and more of it, on more ranks.
#pragma once
#include <string>
#include <vector>

#include "host/cli/render_options.hpp"
#include "host/scene/scene.hpp"

namespace CLI {
class App;
}

namespace raya {

struct BenchRanks {
    std::vector<std::uint32_t> ranks;  // 1 is always among those that are measured
    std::uint32_t samples = 0;         // of each row
    std::string report;                // empty: none
};

/// Width and height of `ranks` times as many pixels, nearly, in the same ratio.
ImageSize size_for(const ImageSize& one, std::uint32_t ranks);

/// Measures, prints a table and writes the report. `options` and `parsed` say what each render is given, `scene` is
/// what `options` name. UserError, RanksFailure; DeviceError where the image differs.
void bench_on_ranks(const CLI::App& parsed, const RenderOptions& options, const Scene& scene, const BenchRanks& asked);

}  // namespace raya
