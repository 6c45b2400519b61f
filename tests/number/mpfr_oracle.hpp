// Computes expected results of the number layer's operations with MPFR: the exact result, rounded once.
#pragma once
#include <mpfr.h>

#include <cmath>
#include <limits>

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

/// Implements kernels/number/README.md for reduced formats with MPFR. The oracle of fp32 is the host's arithmetic,
/// because fp32 has the infinities and denormals of IEEE 754.
class MpfrOracle {
  public:
    explicit MpfrOracle(const NumberFormat& format)
        : range_(range_of(format)),
          largest_(std::ldexp(2 - std::ldexp(1, -format.fraction_bits), range_.highest)),
          rounding_(format.truncates ? MPFR_RNDZ : MPFR_RNDN) {
        mpfr_inits2(kExact, a_, b_, c_, nullptr);
        mpfr_init2(z_, format.fraction_bits + 1);
    }
    MpfrOracle(const MpfrOracle&) = delete;
    MpfrOracle& operator=(const MpfrOracle&) = delete;
    ~MpfrOracle() { mpfr_clears(a_, b_, c_, z_, nullptr); }

    float add(float a, float b) {
        take(a, b);
        mpfr_add(z_, a_, b_, rounding_);
        return fit();
    }
    float sub(float a, float b) {
        take(a, b);
        mpfr_sub(z_, a_, b_, rounding_);
        return fit();
    }
    float mul(float a, float b) {
        take(a, b);
        mpfr_mul(z_, a_, b_, rounding_);
        return fit();
    }
    float div(float a, float b) {
        if (b == 0) return largest(std::signbit(a) != std::signbit(b));
        take(a, b);
        mpfr_div(z_, a_, b_, rounding_);
        return fit();
    }
    float sqrt(float a) {
        if (!(a > 0)) return 0;  // the square root of -0 is +0
        take(a, 0);
        mpfr_sqrt(z_, a_, rounding_);
        return fit();
    }
    float mad(float a, float b, float c) {
        take(a, b);
        mpfr_set_flt(c_, c, MPFR_RNDN);
        mpfr_fma(z_, a_, b_, c_, rounding_);
        return fit();
    }
    float round(double value) {
        mpfr_set_d(z_, value, rounding_);
        return fit();
    }

  private:
    static constexpr mpfr_prec_t kExact = 24;  // bits of precision that hold any fp32 number

    void take(float a, float b) {
        mpfr_set_flt(a_, a, MPFR_RNDN);
        mpfr_set_flt(b_, b, MPFR_RNDN);
    }

    float largest(bool negative) const { return static_cast<float>(negative ? -largest_ : largest_); }

    // Returns z_ saturated or flushed to the format's range. z_ is rounded, but its exponent is not limited to the
    // range.
    float fit() const {
        const bool negative = mpfr_signbit(z_) != 0;
        if (mpfr_inf_p(z_)) return largest(negative);
        if (mpfr_zero_p(z_)) return negative ? -0.0F : 0.0F;
        const mpfr_exp_t exponent = mpfr_get_exp(z_) - 1;  // MPFR's significands lie in [1/2, 1)
        if (exponent > range_.highest) return largest(negative);
        if (exponent < range_.lowest) return negative ? -0.0F : 0.0F;
        return mpfr_get_flt(z_, MPFR_RNDN);
    }

    Range range_;
    double largest_;
    mpfr_rnd_t rounding_;
    mpfr_t a_, b_, c_, z_;
};

}  // namespace raya
