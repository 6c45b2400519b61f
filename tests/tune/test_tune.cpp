// Tests of the report of trials in Kernel Tuner's T4 format, and of the decision whether a candidate is faster.
#include <catch2/catch.hpp>
#include <set>

#include "host/tune/tune.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

Trial make_trial(TrialStatus status) {
    Trial trial;
    trial.status = status;
    trial.ended_at = "2026-11-22T23:59:59Z";
    trial.build_s = 0.5;
    if (status == TrialStatus::kCorrect) trial.samples = {{0.2, 0.1, 0.3}, {0.08, 0.1, 0.24}};
    return trial;
}

TEST_CASE("t4_text: follows results-schema.json 1.0.0", "[tune]") {
    Tuning tuning;
    tuning.workload = default_workloads().front();
    tuning.space = space_of({}, tuning.workload.key());
    for (const TrialStatus status : {TrialStatus::kCorrect, TrialStatus::kCompile, TrialStatus::kRuntime,
                                     TrialStatus::kCorrectness, TrialStatus::kTimeout, TrialStatus::kUnfinished})
        tuning.trials.push_back(make_trial(status));
    const Document report = Document::parse(t4_text({}, {tuning}));
    CHECK(report["schema_version"] == "1.0.0");
    CHECK(report["metadata"]["timeunit"] == "milliseconds");
    const Document& results = report["results"];
    REQUIRE(results.size() == 5);  // without the unfinished trial
    std::vector<std::string> invalidities;
    for (const Document& result : results) {
        for (const char* key : {"configuration", "times", "invalidity", "correctness"}) CHECK(result.contains(key));
        invalidities.push_back(result["invalidity"]);
        CHECK(result["configuration"]["workload"] == "ring none fp32");
        CHECK(result["configuration"].size() == 1 + tuning.space.parameters.size());
        for (const TuningParameter& parameter : tuning.space.parameters)
            CHECK(result["configuration"][parameter.name()].is_number_unsigned());
        CHECK(result["correctness"] == (result["invalidity"] == "correctness" ? 0 : 1));
        CHECK(result["times"]["compilation_time"] == 500.0);
        for (const Document& measurement : result["measurements"])
            CHECK((measurement["name"].is_string() && measurement["value"].is_number() &&
                   measurement["unit"].is_string()));
    }
    CHECK(invalidities == std::vector<std::string>{"correct", "compile", "runtime", "correctness", "timeout"});
    CHECK(results[0]["times"]["runtimes"].size() == 3);
    CHECK(results[0]["measurements"][0]["value"].get<double>() == Approx(80));
}

TEST_CASE("wins_significantly: requires a gain in nearly all pairs of samples, and a gain above the noise", "[tune]") {
    Trial trial = make_trial(TrialStatus::kCorrect);
    const std::vector<double> defaults(9, 0.1), better(9, 0.09);
    trial.samples = {defaults, better};
    CHECK(wins_significantly(trial));
    trial.samples[1][4] = 0.2;  // a sample that other programs slowed down
    CHECK(wins_significantly(trial));
    trial.samples[1][7] = 0.2;
    CHECK_FALSE(wins_significantly(trial));
    trial.samples = {defaults, std::vector<double>(9, 0.099)};  // a gain of 1 % is within the noise
    CHECK_FALSE(wins_significantly(trial));
    CHECK_FALSE(wins_significantly(make_trial(TrialStatus::kCorrectness)));
}

TEST_CASE("ratio_of: is the larger of the ratio of minimum times and the median ratio of sample pairs", "[tune]") {
    const Trial faster = make_trial(TrialStatus::kCorrect);  // minima: 0.08 / 0.1; pairs: 0.4, 1.0, 0.8
    CHECK(ratio_of(faster) == Approx(0.8));
    Trial one_fast_sample = faster;
    one_fast_sample.samples = {{0.2, 0.2, 0.2}, {0.1, 0.2, 0.21}};  // minima: 0.5; median of pairs: 1
    CHECK(ratio_of(one_fast_sample) == Approx(1.0));
    Trial disturbed = faster;
    disturbed.samples = {{0.1, 0.4, 0.4}, {0.2, 0.2, 0.2}};  // minima: 2; median of pairs: 0.5
    CHECK(ratio_of(disturbed) == Approx(2.0));
    CHECK(ratio_of(make_trial(TrialStatus::kTimeout)) == 1);
}

}  // namespace
}  // namespace raya
