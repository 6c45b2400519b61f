// The rows of `raya bench`: renderers that are ready, checked before they are timed.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "report/bench_report.hpp"
#include "ring/ring_renderer.hpp"

namespace raya {

/// One row: a renderer that is ready, and what was measured with it.
struct BenchRow {
    NumberFormat format;
    std::unique_ptr<RingRenderer> renderer;
    RingResult warm_up;
    std::string hash;
    std::vector<double> seconds;  // of each sample, one image each; sorted in the end

    double best() const { return seconds.front(); }
    double median() const { return seconds[seconds.size() / 2]; }
};

/// A row that has rendered once, so that its kernels are built.
BenchRow prepare_row(Session& session, const Scene& scene, RingSettings settings, const NumberFormat& format,
                     std::uint32_t lanes);

/// The first row of the same format: what a row is checked against.
const BenchRow& first_of_format(const std::vector<BenchRow>& rows, const BenchRow& row);

/// DeviceError where rows of one format differ in image or counts.
void check_rows(const std::vector<BenchRow>& rows);

/// `samples` samples of each row, of 20 ms or more. The rows take turns, so that a disturbance from outside hits all of
/// them alike.
void take_samples(std::vector<BenchRow>& rows, int samples);

/// The rows as they stand in a report; before take_samples() without times.
BenchReport bench_report(const std::vector<BenchRow>& rows, const Scene& scene, const RingSettings& settings,
                         const DeviceInfo& device);

}  // namespace raya
