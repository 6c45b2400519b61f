#include "host/study/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace raya {
namespace {

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

double student_probability(double t, std::size_t freedom) {
    const double angle = std::atan(t / std::sqrt(static_cast<double>(freedom)));
    const double cosine = std::cos(angle), sine = std::sin(angle);
    const bool odd = freedom % 2 == 1;
    // Each term is the one before times cosine^2 (k - 1) / k, k as even or odd as the degrees of freedom.
    double term = odd ? cosine : 1, sum = 0;
    for (std::size_t k = odd ? 3 : 2; k <= freedom; k += 2) {
        sum += term;
        term *= cosine * cosine * static_cast<double>(k - 1) / static_cast<double>(k);
    }
    return odd ? 2 / std::numbers::pi * (angle + sine * sum) : sine * sum;
}

double student_t(double confidence, std::size_t freedom) {
    double low = 0, high = 1e5;  // of one degree of freedom it is 2 / (pi (1 - confidence)), of more less
    for (int i = 0; i < 80; ++i) {
        const double middle = (low + high) / 2;
        (student_probability(middle, freedom) < confidence ? low : high) = middle;
    }
    return (low + high) / 2;
}

Estimate estimate_of(const std::vector<double>& values, double confidence) {
    Estimate estimate{mean_of(values), 0, values.size()};
    if (values.size() < 2) return estimate;
    double squares = 0;
    for (const double value : values) squares += (value - estimate.mean) * (value - estimate.mean);
    const auto n = static_cast<double>(values.size());
    estimate.half_width = student_t(confidence, values.size() - 1) * std::sqrt(squares / (n - 1) / n);
    return estimate;
}

Interval prediction_of(std::vector<double> values) {
    constexpr double kTail = 0.025;
    std::ranges::sort(values);
    const std::size_t last = values.size() - 1;
    const double place =
        std::max(0.0, kTail * static_cast<double>(values.size() + 1) - 1);  // from the least, which is 0
    const auto whole = std::min(static_cast<std::size_t>(place), last), next = std::min(whole + 1, last);
    const double part = place - static_cast<double>(whole);
    return {values[whole] + part * (values[next] - values[whole]),
            values[last - whole] + part * (values[last - next] - values[last - whole])};
}

double fitted_exponent(const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<double> u, v;
    for (const double value : x) u.push_back(std::log(value));
    for (const double value : y) v.push_back(std::log(value));
    const double mean_u = mean_of(u), mean_v = mean_of(v);
    double both = 0, squares = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
        both += (u[i] - mean_u) * (v[i] - mean_v);
        squares += (u[i] - mean_u) * (u[i] - mean_u);
    }
    return both / squares;
}

}  // namespace raya
