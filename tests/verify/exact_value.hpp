// Features of the rounding of a result, such as ties and overflow. The known answers are selected so that they cover
// all features.
#pragma once
#include <mpfr.h>

#include <cmath>
#include <set>
#include <string>

#include "host/model/number_format.hpp"
#include "tests/number/mpfr_oracle.hpp"

namespace raya {

/// Precision in bits at which sums, products and a * b + c of fp32 numbers are exact. Quotients and square roots are
/// truncated to this precision.
inline constexpr mpfr_prec_t kExactBits = 700;

/// Feature of a result: rounding the exact value first to fp32 and then to the format gives another result.
inline constexpr const char* kDoubleRounding = "double rounding is wrong";

/// Returns the features of the rounding of `exact` to `expected`: the position of `exact` between neighbouring numbers
/// of the format, a result of 0, infinity or NaN, a carry into the exponent, and kDoubleRounding.
inline std::set<std::string> features_of(mpfr_ptr exact, float expected, const NumberFormat& format) {
    const int bits = format.fraction_bits + 1;
    std::set<std::string> features;
    const auto note = [&](const std::string& feature) {
        features.insert(feature + (std::signbit(expected) ? " -" : " +"));
    };
    if (!mpfr_number_p(exact) || mpfr_zero_p(exact)) {
        note(std::isnan(expected) ? "nan" : std::isinf(expected) ? "infinite" : "zero");
        return features;
    }
    if (expected == 0) {
        note("flushed");
        return features;
    }
    // `exact` truncated to the format's precision, to 1 bit more and to 12 bits more; fine_away: 12 bits more, rounded
    // away from zero.
    Mpfr truncated(bits), half_steps(bits + 1), fine(bits + 12), fine_away(bits + 12);
    Mpfr midpoint(bits + 1);           // of `truncated` and the format's next number away from 0
    Mpfr as_fp32(24), via_fp32(bits);  // `exact` rounded to fp32, and then to the format
    mpfr_set(truncated, exact, MPFR_RNDZ);
    mpfr_set(half_steps, exact, MPFR_RNDZ);
    const bool in_upper_half = mpfr_cmp(truncated, half_steps) != 0;
    mpfr_set(midpoint, truncated, MPFR_RNDZ);
    if (mpfr_cmp_ui(truncated, 0) > 0)
        mpfr_nextabove(midpoint);
    else
        mpfr_nextbelow(midpoint);
    mpfr_set(fine, exact, MPFR_RNDZ);
    mpfr_set(fine_away, exact, MPFR_RNDA);
    const bool rounded_away = mpfr_cmpabs(truncated, (mpfr_set_flt(as_fp32, expected, MPFR_RNDN), as_fp32)) < 0;
    if (mpfr_cmp(exact, truncated) == 0)
        note("exact");
    else if (in_upper_half && mpfr_cmp(exact, half_steps) == 0)
        note(rounded_away ? "tie up" : "tie down");
    else if (mpfr_cmp(fine, midpoint) == 0)
        note("just above a tie");
    else if (mpfr_cmp(fine_away, midpoint) == 0)
        note("just below a tie");
    else if (mpfr_cmp(fine, truncated) == 0)
        note("just above a number");
    else
        note(in_upper_half ? "upper half" : "lower half");
    // Rounding to fp32 first may give another result.
    mpfr_set(as_fp32, exact, MPFR_RNDN);
    mpfr_set(via_fp32, as_fp32, format.truncates ? MPFR_RNDZ : MPFR_RNDN);
    if (bits < 24 && mpfr_get_flt(via_fp32, MPFR_RNDN) != expected) features.insert(kDoubleRounding);
    int exponent = 0;
    if (rounded_away && std::frexp(std::abs(expected), &exponent) == 0.5F) note("carries into the next binade");
    return features;
}

}  // namespace raya
