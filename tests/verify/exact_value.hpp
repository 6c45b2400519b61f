// MPFR numbers for the exact results of operations, and features of the rounding of a result, such as ties and
// overflow. The known answers are selected so that they cover all features.
#pragma once
#include <mpfr.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>

#include "host/model/number_format.hpp"
#include "tests/number/mpfr_oracle.hpp"

namespace raya {

/// An MPFR number with a given precision in bits.
class Mpfr {
  public:
    explicit Mpfr(mpfr_prec_t bits) { mpfr_init2(value_, bits); }
    Mpfr(const Mpfr&) = delete;
    Mpfr& operator=(const Mpfr&) = delete;
    ~Mpfr() { mpfr_clear(value_); }
    operator mpfr_ptr() { return value_; }  // NOLINT: MPFR's functions take an mpfr_ptr

  private:
    mpfr_t value_;
};

/// Precision in bits at which sums, products and a * b + c of fp32 numbers are exact. Quotients and square roots are
/// truncated to this precision.
inline constexpr mpfr_prec_t kExactBits = 700;

/// fp32 operations computed with MPFR, with the infinities, NaNs and denormal numbers of IEEE 754.
class IeeeOracle {
  public:
    float add(float a, float b) {
        return rounded([&](mpfr_ptr z) { return mpfr_add(z, assign(a_, a), assign(b_, b), MPFR_RNDN); });
    }
    float sub(float a, float b) {
        return rounded([&](mpfr_ptr z) { return mpfr_sub(z, assign(a_, a), assign(b_, b), MPFR_RNDN); });
    }
    float mul(float a, float b) {
        return rounded([&](mpfr_ptr z) { return mpfr_mul(z, assign(a_, a), assign(b_, b), MPFR_RNDN); });
    }
    float div(float a, float b) {
        return rounded([&](mpfr_ptr z) { return mpfr_div(z, assign(a_, a), assign(b_, b), MPFR_RNDN); });
    }
    float sqrt(float a) {
        return rounded([&](mpfr_ptr z) { return mpfr_sqrt(z, assign(a_, a), MPFR_RNDN); });
    }
    float mad(float a, float b, float c) {
        return rounded([&](mpfr_ptr z) { return mpfr_fma(z, assign(a_, a), assign(b_, b), assign(c_, c), MPFR_RNDN); });
    }
    float round(double value) { return static_cast<float>(value); }

  private:
    // Assigns `value` to `number`, and returns `number`.
    static mpfr_ptr assign(Mpfr& number, float value) {
        mpfr_set_flt(number, value, MPFR_RNDN);
        return number;
    }
    template <class Operation>
    float rounded(const Operation& operation) {
        const mpfr_exp_t min_exponent = mpfr_get_emin(), max_exponent = mpfr_get_emax();
        int inexact = operation(z_);
        mpfr_set_emin(-148);  // exponent range of binary32 (MPFR manual)
        mpfr_set_emax(128);
        inexact = mpfr_check_range(z_, inexact, MPFR_RNDN);
        mpfr_subnormalize(z_, inexact, MPFR_RNDN);
        mpfr_set_emin(min_exponent);
        mpfr_set_emax(max_exponent);
        return mpfr_get_flt(z_, MPFR_RNDN);
    }

    Mpfr a_{24}, b_{24}, c_{24}, z_{24};
};

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
