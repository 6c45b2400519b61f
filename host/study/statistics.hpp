// What an ensemble of measurements tells: a mean and how well it is known, and how a figure grows.
#pragma once
#include <cstddef>
#include <vector>

namespace raya {

/// The mean of independent measurements and the half width of its 95 % confidence interval.
struct Estimate {
    double mean = 0;
    double half_width = 0;  // 0 where there is but one measurement: nothing is known of how they scatter
    std::size_t count = 0;

    double low() const { return mean - half_width; }
    double high() const { return mean + half_width; }
    bool has_interval() const { return count > 1; }
};

/// By Student's t distribution: exact for measurements that scatter normally. One at least.
Estimate estimate_of(const std::vector<double>& values);

/// The probability that |t| of Student's distribution with so many degrees of freedom, 1 at least, is at most `t` >= 0
/// (Abramowitz & Stegun 1964, 26.7.3 and 26.7.4).
double student_probability(double t, std::size_t freedom);

/// The t for which that probability is 95 %.
double student_t95(std::size_t freedom);

/// The exponent e for which c x^e lies nearest to y, by least squares of the logarithms; all above zero, two different
/// x at least.
double fitted_exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace raya
