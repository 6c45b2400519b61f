// Means, their intervals and exponents, against printed tables, hand-made figures and draws of a known distribution.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "host/study/statistics.hpp"

namespace raya {
namespace {

TEST_CASE("one more measurement lies in the prediction with 95 %, whatever the distribution", "[statistics]") {
    std::mt19937 random(11);
    std::normal_distribution<double> draw(0, 1);
    constexpr int kTrials = 4000;
    for (const bool skew : {false, true})
        for (const std::size_t count : {39u, 64u, 100u}) {
            int within = 0;
            const auto one = [&] { return skew ? std::exp(2 * draw(random)) : draw(random); };
            for (int i = 0; i < kTrials; ++i) {
                std::vector<double> values(count);
                std::ranges::generate(values, one);
                within += prediction_of(values).holds(one());
            }
            CAPTURE(skew, count, within);
            CHECK(std::abs(within / double(kTrials) - 0.95) < 0.012);  // 3.5 standard deviations
        }
}

TEST_CASE("a prediction leaves out a fortieth of the places at either end", "[statistics]") {
    const auto of = [](std::size_t count) {
        std::vector<double> values(count);
        std::iota(values.rbegin(), values.rend(), 1.0);
        return prediction_of(values);
    };
    CHECK((of(39).least == Approx(1) && of(39).most == Approx(39)));
    CHECK((of(64).least == Approx(1.625) && of(64).most == Approx(63.375)));
    CHECK((of(79).least == Approx(2) && of(79).most == Approx(78)));
    CHECK((of(2).least == 1 && of(2).most == 2));
    CHECK((of(1).least == 1 && of(1).most == 1));
}

// Two-sided 95 %: any table of Student's t.
TEST_CASE("Student's t at 95 % is the one in tables", "[statistics]") {
    const std::pair<std::size_t, double> printed[] = {{1, 12.706}, {2, 4.303},  {3, 3.182},  {4, 2.776},
                                                      {5, 2.571},  {9, 2.262},  {10, 2.228}, {29, 2.045},
                                                      {30, 2.042}, {60, 2.000}, {99, 1.984}, {120, 1.980}};
    for (const auto& [freedom, t] : printed) {
        CAPTURE(freedom);
        CHECK(student_t(0.95, freedom) == Approx(t).margin(5e-4));
        CHECK(student_probability(student_t(0.95, freedom), freedom) == Approx(0.95).epsilon(1e-12));
    }
    CHECK(student_t(0.95, 100'000) == Approx(1.95996).margin(1e-4));  // the normal distribution's
}

TEST_CASE("Student's t of other levels is the one in tables too", "[statistics]") {
    CHECK(student_t(0.99, 1) == Approx(63.657).margin(1e-2));
    CHECK(student_t(0.99, 10) == Approx(3.169).margin(1e-3));
    CHECK(student_t(0.999, 30) == Approx(3.646).margin(1e-3));
    CHECK(each_of(10) == Approx(0.995));
    CHECK(estimate_of({2, 4, 4, 6}, 0.99).half_width == Approx(5.841 * std::sqrt(8.0 / 3 / 4)).epsilon(1e-3));
}

TEST_CASE("the probability within t runs from 0 to 1, and is the arc tangent's for one degree of freedom",
          "[statistics]") {
    for (std::size_t freedom = 1; freedom < 40; ++freedom) {
        CAPTURE(freedom);
        CHECK(student_probability(0, freedom) == 0);
        double before = 0;
        for (double t = 0.25; t < 8; t += 0.25) {
            const double now = student_probability(t, freedom);
            CHECK(now > before);
            CHECK(now < 1);
            before = now;
        }
    }
    CHECK(student_probability(1, 1) == Approx(0.5));
    CHECK(student_probability(std::sqrt(2.0), 2) == Approx(std::sqrt(0.5)));
}

TEST_CASE("an estimate is the mean and t standard errors of it", "[statistics]") {
    const Estimate four = estimate_of({2, 4, 4, 6});
    CHECK(four.mean == 4);
    CHECK(four.half_width == Approx(student_t(0.95, 3) * std::sqrt(8.0 / 3 / 4)));
    CHECK(four.low() == Approx(4 - four.half_width));
    CHECK(four.high() == Approx(4 + four.half_width));
    CHECK(four.has_interval());
    const Estimate one = estimate_of({7});
    CHECK(one.mean == 7);
    CHECK(one.half_width == 0);
    CHECK_FALSE(one.has_interval());
    CHECK(estimate_of({3, 3, 3}).half_width == 0);
}

TEST_CASE("of draws of a known mean, 95 of 100 intervals hold it", "[statistics]") {
    std::mt19937 random(71);
    std::normal_distribution<double> draw(10, 3);
    for (const int size : {2, 5, 20}) {
        constexpr int kTrials = 4000;
        int held = 0;
        for (int i = 0; i < kTrials; ++i) {
            std::vector<double> values;
            for (int n = 0; n < size; ++n) values.push_back(draw(random));
            const Estimate e = estimate_of(values);
            held += e.low() <= 10 && 10 <= e.high();
        }
        CAPTURE(size);
        CHECK(held / double(kTrials) == Approx(0.95).margin(0.015));  // four standard deviations
    }
}

TEST_CASE("an exponent is the power's, whatever the factor, and lies between those that it is fitted to",
          "[statistics]") {
    for (const double power : {-1.0, 0.0, 0.25, 1.0, 3.0}) {
        std::vector<double> x, y;
        for (double at = 10; at < 1e6; at *= 7) {
            x.push_back(at);
            y.push_back(0.03 * std::pow(at, power));
        }
        CHECK(fitted_exponent(x, y) == Approx(power).margin(1e-12));
    }
    CHECK(fitted_exponent({1, 10, 100}, {1, 1, 100}) == Approx(1));  // of a level and a steep half
}

}  // namespace
}  // namespace raya
