// What an ensemble of measurements tells: a mean and how well it is known, and how a figure grows.
#pragma once
#include <cstddef>
#include <vector>

namespace raya {

/// The mean of independent measurements and the half width of its confidence interval, of 95 % mostly.
struct Estimate {
    double mean = 0;
    double half_width = 0;  // 0 where there is but one measurement: nothing is known of how they scatter
    std::size_t count = 0;

    double low() const { return mean - half_width; }
    double high() const { return mean + half_width; }
    bool has_interval() const { return count > 1; }
};

/// By Student's t distribution: exact for measurements that scatter normally. One at least. Another `confidence` than
/// 95 % is for intervals that are to hold all at once.
Estimate estimate_of(const std::vector<double>& values, double confidence = 0.95);

/// That of each of n intervals, if all n are to hold together with 95 % (Bonferroni).
inline double each_of(std::size_t n) { return 1 - 0.05 / static_cast<double>(n); }

/// A range that figures leave open.
struct Interval {
    double least, most;
    double middle() const { return (least + most) / 2; }
    bool holds(double value) const { return value >= least && value <= most; }
};

/// So many measurements at least has a prediction of 95 %: the least and the largest of fewer hold less.
inline constexpr std::size_t kPredictable = 39;

/// Between what one more measurement lies with 95 %, whatever their distribution: the least and the largest but
/// 0.025 (n + 1) of each, of which a fraction is taken linearly, as the k-th of n is passed by another one with
/// k / (n + 1) (order statistics; Wilks, Ann. Math. Stat. 12, 1941). The least and the largest where there are fewer
/// than kPredictable.
Interval prediction_of(std::vector<double> values);

/// The probability that |t| of Student's distribution with so many degrees of freedom, 1 at least, is at most `t` >= 0
/// (Abramowitz & Stegun 1964, 26.7.3 and 26.7.4).
double student_probability(double t, std::size_t freedom);

/// The t for which that probability is `confidence`, below 1 by 1e-5 or more.
double student_t(double confidence, std::size_t freedom);

/// The exponent e for which c x^e lies nearest to y, by least squares of the logarithms; all above zero, two different
/// x at least.
double fitted_exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace raya
