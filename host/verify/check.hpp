// One thing that verify looks at, and what came of it.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

/// "PASS", "FAIL", "SKIP".
const char* outcome_name(Outcome outcome);

struct Check {
    std::string layer, name;  // "number", "e6m15, 16 lanes"
    double seconds = 0;       // measured
    Verdict verdict;
};

/// Runs `body` and measures it. What it throws is a check that failed with that message, not the end of the others:
/// drivers refuse, and a machine whose arithmetic is wrong may lose packets, which the torus reports as a fault of
/// ours.
Check run_check(const std::string& layer, const std::string& name, const std::function<Verdict()>& body);

/// What to try where the compiler or the driver may be at fault, without what is tried already.
std::vector<std::string> compiler_remedies();

/// How many of `checks` ended so.
std::size_t count_of(const std::vector<Check>& checks, Outcome outcome);

/// "PASS  number    e6m15, 16 lanes  310 answers  0.41 s", and indented lines for a fault.
std::string check_lines(const Check& check);

/// An object with layer, name, status, seconds and told; of a failure also where, expected, got, build_options and
/// remedies.
Json to_json(const Check& check);

/// The inverse.
Check check_of(const Json& json);

}  // namespace raya
