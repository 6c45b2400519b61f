// Computes expected results of the number layer's operations with MPFR: the exact result, rounded once.
#pragma once
#include <mpfr.h>

#include <cmath>

#include "host/model/number_format.hpp"

namespace raya {

/// The range of the unbiased exponents of a format's numbers, as for normal numbers in IEEE 754.
struct Range {
    int lowest, highest;  // the smallest number is 2^lowest; the largest is below 2^(highest + 1)
};

inline Range range_of(const NumberFormat& format) {
    const int highest = (1 << (format.exponent_bits - 1)) - 1;
    return {1 - highest, highest};
}

/// An MPFR number with a given precision in bits.
class Mpfr {
  public:
    explicit Mpfr(mpfr_prec_t bits) { mpfr_init2(value_, bits); }
    Mpfr(const Mpfr&) = delete;
    Mpfr& operator=(const Mpfr&) = delete;
    ~Mpfr() { mpfr_clear(value_); }
    operator mpfr_ptr() { return value_; }           // NOLINT: MPFR's functions take an mpfr_ptr
    operator mpfr_srcptr() const { return value_; }  // NOLINT

  private:
    mpfr_t value_;
};

/// Implements kernels/number/README.md: reduced formats saturate and flush; fp32 has the infinities, NaNs and denormal
/// numbers of IEEE 754.
class MpfrOracle {
  public:
    /// `flushes`: fp32 of a device that replaces denormal operands and results by zeros of the same sign.
    explicit MpfrOracle(const NumberFormat& format, bool flushes = false)
        : is_fp32_(format.is_fp32()),
          flushes_(flushes && is_fp32_),
          range_(range_of(format)),
          largest_(std::ldexp(2 - std::ldexp(1, -format.fraction_bits), range_.highest)),
          rounding_(format.truncates ? MPFR_RNDZ : MPFR_RNDN),
          z_(format.fraction_bits + 1) {}

    float add(float a, float b) { return result(mpfr_add, a, b); }
    float sub(float a, float b) { return result(mpfr_sub, a, b); }
    float mul(float a, float b) { return result(mpfr_mul, a, b); }
    float div(float a, float b) {
        return b == 0 && !is_fp32_ ? largest(std::signbit(a) != std::signbit(b)) : result(mpfr_div, a, b);
    }
    float sqrt(float a) {
        if (!is_fp32_ && !(a > 0)) return 0;  // the square root of -0 is +0
        return fit(mpfr_sqrt(z_, assign(a_, a), rounding_));
    }
    float mad(float a, float b, float c) {
        return fit(mpfr_fma(z_, assign(a_, a), assign(b_, b), assign(c_, c), rounding_));
    }
    float round(double value) { return fit(mpfr_set_d(z_, value, rounding_)); }

    /// Returns the number; zero if it is denormal and the device flushes.
    float flush(float x) const { return flushes_ && std::fpclassify(x) == FP_SUBNORMAL ? std::copysign(0.0F, x) : x; }

  private:
    using Operation = int(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);

    float result(Operation* operation, float a, float b) {
        return fit(operation(z_, assign(a_, a), assign(b_, b), rounding_));
    }

    mpfr_srcptr assign(Mpfr& number, float value) const {
        mpfr_set_flt(number, flush(value), MPFR_RNDN);
        return number;
    }

    float largest(bool negative) const { return static_cast<float>(negative ? -largest_ : largest_); }

    // Returns z_, which is rounded, but whose exponent is not limited to the range, as a number of the format.
    // `inexact`: MPFR's return value for z_.
    float fit(int inexact) {
        if (is_fp32_) return fit_to_fp32(inexact);
        const mpfr_srcptr z = z_;
        const bool negative = mpfr_signbit(z) != 0;
        if (mpfr_inf_p(z)) return largest(negative);
        if (mpfr_zero_p(z)) return negative ? -0.0F : 0.0F;
        const mpfr_exp_t exponent = mpfr_get_exp(z) - 1;  // MPFR's significands lie in [1/2, 1)
        if (exponent > range_.highest) return largest(negative);
        if (exponent < range_.lowest) return negative ? -0.0F : 0.0F;
        return mpfr_get_flt(z_, MPFR_RNDN);
    }

    float fit_to_fp32(int inexact) {
        const mpfr_exp_t min_exponent = mpfr_get_emin(), max_exponent = mpfr_get_emax();
        mpfr_set_emin(-148);  // exponent range of binary32 (MPFR manual)
        mpfr_set_emax(128);
        inexact = mpfr_check_range(z_, inexact, rounding_);
        mpfr_subnormalize(z_, inexact, rounding_);
        mpfr_set_emin(min_exponent);
        mpfr_set_emax(max_exponent);
        return flush(mpfr_get_flt(z_, MPFR_RNDN));
    }

    static constexpr mpfr_prec_t kExact = 24;  // bits of precision that hold any fp32 number

    bool is_fp32_, flushes_;
    Range range_;
    double largest_;
    mpfr_rnd_t rounding_;
    Mpfr a_{kExact}, b_{kExact}, c_{kExact}, z_;
};

}  // namespace raya
