// Random operands, many of them hard cases for correct rounding: ties, cancellation, the ends of the format's range.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/scene/split_mix.hpp"
#include "host/verify/numbers.hpp"
#include "tests/number/mpfr_oracle.hpp"

namespace raya {

class RandomOperands {
  public:
    RandomOperands(const NumberFormat& format, std::uint64_t seed)
        : format_(format), range_(range_of(format)), random_(seed) {}

    /// Returns `count` rows of operands a, b, c.
    NumberRows rows(std::size_t count) {
        NumberRows rows;
        for (std::size_t i = 0; i < count; ++i) {
            const float a = number(below(4) == 0 ? end_exponent() : any_exponent());
            const float b = number(second_exponent(a));
            rows.add(a, b, addend(a, b));
        }
        return rows;
    }

  private:
    int below(int n) { return static_cast<int>(random_.next() >> 33) % n; }
    int within(int lowest, int highest) { return lowest + below(highest - lowest + 1); }
    int any_exponent() { return within(range_.lowest, range_.highest); }
    int end_exponent() { return below(2) == 0 ? range_.lowest + below(3) : range_.highest - below(3); }
    float sign() { return below(2) == 0 ? -1.0F : 1.0F; }
    bool coin() { return below(2) == 0; }

    // Returns the fraction bits of a number, 0 .. 2^Y - 1.
    std::uint32_t fraction() {
        const std::uint32_t all = (1u << format_.fraction_bits) - 1;
        const auto bit = [&] { return 1u << below(format_.fraction_bits); };
        const auto any = static_cast<std::uint32_t>(random_.next() >> 32) & all;
        const int cut = below(format_.fraction_bits);
        switch (below(8)) {
            case 0:
                return 0;  // power of two
            case 1:
                return bit() | bit();  // one or two bits are 1
            case 2:
                return all & ~(bit() | (coin() ? bit() : 0));  // one or two bits are 0
            case 3:
                return coin() ? all : 1;  // next to a power of two
            case 4:
            case 5:
                return (any >> cut | 1) << cut;  // trailing zeros: the product of two such numbers may be a tie
            default:
                return any;
        }
    }

    // Returns a number of the format with the given exponent, clamped to the format's range; sometimes zero.
    float number(int exponent) {
        if (below(128) == 0) return 0 * sign();
        const int e = std::clamp(exponent, range_.lowest, range_.highest);
        const auto significand = static_cast<float>((1u << format_.fraction_bits) + fraction());  // exact
        return sign() * std::ldexp(significand, e - format_.fraction_bits);
    }

    int exponent_of(double value) { return value == 0 ? any_exponent() : std::ilogb(value); }

    // Returns an exponent for the operand b, chosen so that many operations on a and b are hard cases.
    int second_exponent(float a) {
        const int e = exponent_of(a), max_distance = format_.fraction_bits + 4;
        switch (below(6)) {
            case 0:
                return e + within(-max_distance, max_distance);  // sums that are rounded
            case 1:
                return e + within(-1, 1);  // differences with cancellation
            case 2:
                return (coin() ? range_.lowest : range_.highest) - e + within(-2, 2);  // products near the ends
            case 3:
                return e - (coin() ? range_.lowest : range_.highest) + within(-2, 2);  // quotients near the ends
            default:
                return any_exponent();
        }
    }

    // Returns the third operand of a multiply-accumulate, chosen relative to the product a b, which a double holds
    // exactly.
    float addend(float a, float b) {
        const double product = static_cast<double>(a) * b;
        const int e = exponent_of(product), y = format_.fraction_bits;
        switch (below(8)) {
            case 0:
                return rounded(-product);  // cancels the product's leading bits
            case 1:
                return rounded(-product +
                               std::ldexp(within(-2, 2), e - y));  // cancels all but up to two units in the last place
            case 2:
                return rounded(addend_for_tie(product));  // the sum is a tie or next to one
            case 3:
                return number(e - within(y, 3 * y + 10));  // c is much smaller than the product
            case 4:
                return number(e + within(y, 3 * y + 10));  // c is much larger than the product
            case 5:
                return number(e + y + 1);  // the product is about half a unit in the last place of c
            case 6:
                return number(e + within(-y - 2, y + 2));
            default:
                return number(any_exponent());
        }
    }

    // Returns the number that must be added to the product so that the sum is a tie: the middle between two numbers of
    // the format.
    double addend_for_tie(double product) {
        const int e = exponent_of(product), y = format_.fraction_bits;
        const double unit = std::ldexp(1, e - y);
        return (std::floor(product / unit) + 0.5) * unit - product;
    }

    float rounded(double value) { return round_to_format(value, format_); }

    NumberFormat format_;
    Range range_;
    SplitMix random_;
};

}  // namespace raya
