// Results of a soak test (verify_at_random()): which checks failed, when, how often, and with which first wrong word.
#pragma once
#include <map>
#include <string>

#include "host/verify/verify.hpp"

namespace raya {

class SoakCounts {
  public:
    /// Counts a check that has ended `seconds` after the start. Returns the lines to print: none if the check has
    /// passed; its details only for the first failure of the check.
    std::string add(const Check& check, double seconds);

    /// Returns a line for each check that has failed, such as "machine bus: failed 2 of 31 times, first after 12.3 s; 2
    /// times with the same first wrong word: ...".
    std::string summary() const;

  private:
    struct Count {
        std::size_t runs = 0, failures = 0;
        std::size_t repeats = 0;  // number of failures that equal the first one
        double first_s = 0;
        std::string first_wrong{};  // place, expected and actual bits of the first failure
    };
    std::map<std::string, Count> counts_;  // by "LAYER NAME"
};

}  // namespace raya
