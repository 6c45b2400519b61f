// Tests of the decision whether a candidate is faster.
#include <catch2/catch.hpp>

#include "host/tune/tune.hpp"

namespace raya {
namespace {

Trial make_trial(const std::string& error = {}) {
    Trial trial;
    trial.error = error;
    if (error.empty()) trial.samples = {{0.2, 0.1, 0.3}, {0.08, 0.1, 0.24}};
    return trial;
}

TEST_CASE("wins_significantly: requires a gain in nearly all pairs of samples, and a gain above the noise", "[tune]") {
    Trial trial = make_trial();
    const std::vector<double> defaults(9, 0.1), better(9, 0.09);
    trial.samples = {defaults, better};
    CHECK(wins_significantly(trial));
    trial.samples[1][4] = 0.2;  // a sample that other programs slowed down
    CHECK(wins_significantly(trial));
    trial.samples[1][7] = 0.2;
    CHECK_FALSE(wins_significantly(trial));
    trial.samples = {defaults, std::vector<double>(9, 0.099)};  // a gain of 1 % is within the noise
    CHECK_FALSE(wins_significantly(trial));
    CHECK_FALSE(wins_significantly(make_trial("correctness: image is x")));
}

TEST_CASE("ratio_of: is the larger of the ratio of minimum times and the median ratio of sample pairs", "[tune]") {
    const Trial faster = make_trial();  // minima: 0.08 / 0.1; pairs: 0.4, 1.0, 0.8
    CHECK(ratio_of(faster) == Approx(0.8));
    Trial one_fast_sample = faster;
    one_fast_sample.samples = {{0.2, 0.2, 0.2}, {0.1, 0.2, 0.21}};  // minima: 0.5; median of pairs: 1
    CHECK(ratio_of(one_fast_sample) == Approx(1.0));
    Trial disturbed = faster;
    disturbed.samples = {{0.1, 0.4, 0.4}, {0.2, 0.2, 0.2}};  // minima: 2; median of pairs: 0.5
    CHECK(ratio_of(disturbed) == Approx(2.0));
    CHECK(ratio_of(make_trial("timeout: not done in 20 s")) == 1);
}

}  // namespace
}  // namespace raya
