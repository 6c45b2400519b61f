// The one clock of all pages that tell modelled times of the SPA, and how sure it is.
//
// Computing is the instruction budget's cycles of 100 ns times a factor for what the budget does not see; rotations,
// exchanges and transfers are at the rates of the real machine. The factor is taken from the filter, the only
// computing of Kohata & Ito that depends on no scene: Tables 3 and 4 leave 7 ms for it [D], the budget has 1.0752 ms.
// That it holds for ray tracing too is an assumption, so conclusions are shown for factors of 1 to 8.
#pragma once
#include <array>
#include <string>

#include "host/study/statistics.hpp"

namespace raya {

/// Times a budget cycle, with what the rounding of the printed times allows.
struct MachineFactor {
    double value, least, most;
};
MachineFactor machine_factor();

inline constexpr std::array kFactors = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0};

/// What a page says of its clock.
std::string clock_text();

/// What a call of the host takes beside the PEs' computing: set-up, for each rotation its synchronisation and words,
/// and the words that go through the host. From the printed 2 and 12 ms (Table 4, 2 and 34 rotations) and 140 ms (Table
/// 2, 256 x 256 pixels of 3 words), each rounded to 1 ms.
struct HostModel {
    Interval setup_ms;     // of a call, [D] with the printed rotations
    Interval rotation_ms;  // of one rotation of 768 words
    Interval words_per_s;  // of the host, if the transfer of the image is one call with that set-up

    /// Milliseconds of a call that moves so many words through the host.
    Interval call_ms(double words) const;
};
HostModel host_model();

}  // namespace raya
