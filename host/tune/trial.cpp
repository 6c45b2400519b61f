#include "host/tune/trial.hpp"

#include <algorithm>

#include "host/base/json.hpp"
#include "host/base/own_process.hpp"
#include "host/cl/driver_call.hpp"
#include "host/error.hpp"
#include "host/tune/values_json.hpp"

namespace raya {
namespace {

constexpr std::size_t kLeastSamples = 2;  // before a candidate is given up
constexpr double kFarSlower = 1.25;

// Of what lasts less than 20 ms the mean of as many as last that long: clock and launch would count in.
double sample_of(const TrialRender& render) {
    constexpr double kLeastSeconds = 0.02;
    double sum = 0;
    int images = 0;
    for (; sum < kLeastSeconds; ++images) sum += render.image_s();
    return sum / images;
}

double least(const std::vector<double>& seconds) { return *std::min_element(seconds.begin(), seconds.end()); }

std::vector<std::vector<double>> samples_of(const std::vector<TrialRender>& renders, const TrialOrder& order) {
    std::vector<std::vector<double>> all(renders.size());
    for (std::uint32_t i = 0; i < order.samples; ++i) {
        for (std::size_t n = 0; n < renders.size(); ++n) all[n].push_back(sample_of(renders[n]));
        const bool enough = order.stop_early && all.front().size() >= kLeastSamples;
        if (enough && least(all.back()) > kFarSlower * least(all.front())) break;
    }
    return all;
}

void run(int lines, const std::string& device, const TrialOrder& order, const WorkloadPicture& picture,
         const KernelSources& sources) {
    Session session(choose_device(device));
    KernelChoice kernels;
    kernels.sources = sources;
    std::vector<TrialRender> renders;
    for (const TunedValues& values : order.candidates) {
        const auto built = [&] { send_line(lines, Json{{"built", renders.size()}}.dump()); };
        renders.push_back(prepare_render(session, order.workload, picture, with_values(kernels, values), built));
        const TrialRender& made = renders.back();
        send_line(lines, Json{{"check", made.check}, {"build_s", made.build_s}}.dump());
    }
    Json all = Json::list();
    for (const std::vector<double>& samples : samples_of(renders, order)) all.push_back(samples);
    send_line(lines, Json{{"samples", all}}.dump());
}

}  // namespace

std::string TrialOrder::text() const {
    Json all = Json::list();
    for (const TunedValues& values : candidates) all.push_back(to_json(values));
    return Json{{"way", workload.way},
                {"format", format_name(workload.format)},
                {"samples", samples},
                {"stop_early", stop_early ? 1 : 0},
                {"candidates", all}}
        .dump();
}

TrialOrder TrialOrder::of(const std::string& text) {
    return read_json(text, {"the order of a trial"}, [](const Json& json) {
        TrialOrder order{.workload = {json.at("way").text(), parse_format(json.at("format").text())},
                         .candidates = {},
                         .samples = static_cast<std::uint32_t>(json.at("samples").whole(1000)),
                         .stop_early = json.at("stop_early").whole(1) == 1};
        for (const Json& values : json.at("candidates").elements()) order.candidates.push_back(values_of(values));
        return order;
    });
}

double median_ratio(const std::vector<double>& of, const std::vector<double>& over) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(of.size(), over.size()); ++i) ratios.push_back(of[i] / over[i]);
    if (ratios.empty()) return 1;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle;
}

double ratio_of(const Trial& trial) {
    if (trial.samples.empty() || trial.samples.front().empty() || trial.samples.back().empty()) return 1;
    const std::vector<double>&of = trial.samples.back(), &over = trial.samples.front();
    return std::max(least(of) / least(over), median_ratio(of, over));
}

bool wins_surely(const Trial& trial) {
    if (trial.fate != Fate::kCorrect || ratio_of(trial) > kLeastWin) return false;
    const std::vector<double>&of = trial.samples.back(), &over = trial.samples.front();
    std::size_t lost = 0;
    for (std::size_t i = 0; i < of.size(); ++i) lost += of[i] >= over[i];
    return lost <= of.size() / 9;
}

void run_trial(int lines, const std::string& device, const TrialOrder& order, const Scene* given, const ImageSize& size,
               std::uint32_t pes, const KernelSources& sources) {
    leave_driver_crashes();  // the supervisor tells of them
    keep_lines_to_oneself(lines);
    const auto stop = [&](const std::exception& error, const char* kind) {
        send_line(lines, Json{{"error", error.what()}, {"kind", kind}}.dump());
    };
    try {
        run(lines, device, order, picture_of(order.workload, given, size, pes), sources);
    } catch (const UserError& error) {
        stop(error, "user");
    } catch (const std::exception& error) {
        stop(error, "device");
    }
}

}  // namespace raya
