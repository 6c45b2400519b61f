// The operations of random kernels (random_kernel.hpp): for each one its text in a kernel and its exact result.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "host/verify/random_kernel.hpp"

namespace raya {

constexpr bool is_integer(Scalar s) { return s < Scalar::kFloat; }
constexpr bool is_signed(Scalar s) { return is_integer(s) && static_cast<int>(s) % 2 == 0; }
constexpr int bits_of(Scalar s) { return is_integer(s) ? 8 << static_cast<int>(s) / 2 : 32; }
constexpr Scalar with_sign(Scalar s, bool has_sign) {
    const int bits = bits_of(s);
    return static_cast<Scalar>(2 * (std::countr_zero(static_cast<unsigned>(bits)) - 3) + !has_sign);
}

/// Values are bits of the type's width, the higher ones zero.
using Bits = std::uint64_t;
constexpr Bits mask_of(Scalar s) { return ~Bits{0} >> (64 - bits_of(s)); }
constexpr Bits cut(Scalar s, Bits x) { return x & mask_of(s); }
/// The value of an integer, signed types sign-extended.
constexpr std::int64_t value_of(Scalar s, Bits x) {
    const int unused = 64 - bits_of(s);
    return is_signed(s) ? static_cast<std::int64_t>(x << unused) >> unused : static_cast<std::int64_t>(x);
}
inline float float_of(Bits x) { return std::bit_cast<float>(static_cast<std::uint32_t>(x)); }

/// Results whose magnitude is outside 2^-60..2^60 become 1: no NaN, infinity or denormal number occurs.
inline Bits safe_bits(float x) {
    const float magnitude = std::abs(x);
    return std::bit_cast<std::uint32_t>(magnitude >= 0x1p-60F && magnitude <= 0x1p60F ? x : 1.0F);
}

/// Bits with which variables and elements of memory start: 0, or the float 1.
inline Bits start_of(Scalar s) { return is_integer(s) ? 0 : safe_bits(1); }

/// How the generator chooses an operation: among all of a group, or by its number.
enum class Group { kByNumber, kInteger, kFloat, kReal, kCompare };

enum OperationNumber : std::size_t {
    kConstant,
    kVariable,
    kInput,    // word argument 0 + the number of the work-item of the input
    kElement,  // element argument 0 of memory object `object`, field `number`
    kCallFunction,
    kMake,    // a vector of scalars
    kSpread,  // a vector of one scalar
    kSwizzle,
    kShuffle,
    kSelect,  // argument 0 if argument 2 holds, else argument 1
    kAll,     // of a vector of truth values
    kAny,
    kConvert,   // an integer to one of any width
    kSaturate,  // an integer or float to an integer
    kToFloat,   // an integer / 2^12 to float
    kBitsOf,    // the bits of a float, or of an integer of the other sign
    kFloatOf,   // a float of these bits
    kRealOf,    // a float, rounded to the format
    kRealOfIndex,
    kFloatOfReal,
    kAdd,
    kSubtract,
    kMultiply,
    kAnd
};

/// Elements of the arguments; the scalar types of the result and of the first argument.
struct Operands {
    Scalar to, from;
    Bits a, b, c;
    const NumberFormat& format;
};

/// `text`: "+" for a + b modulo 2^bits, or a pattern with the arguments {0}, {1}, {2}, the type {T},
/// its number of bits {BITS} and largest signed value {MAX}. `apply`: an element of the result.
struct KernelOperation {
    Group group;
    const char* text;
    int arguments;
    Bits (*apply)(const Operands&);
};

// 128-bit products and sums are exact.
__extension__ typedef __int128 Wide;
inline Wide wide(Scalar s, Bits x) { return is_signed(s) ? static_cast<Wide>(value_of(s, x)) : static_cast<Wide>(x); }
inline Bits cut_wide(Scalar s, Wide x) { return cut(s, static_cast<Bits>(x)); }
inline Bits saturated(Scalar s, Wide x) {
    const Wide max = static_cast<Wide>(is_signed(s) ? mask_of(s) >> 1 : mask_of(s)), min = is_signed(s) ? -max - 1 : 0;
    return cut_wide(s, std::clamp(x, min, max));
}
inline Bits shift_count(Scalar s, Bits b) { return b & static_cast<Bits>(bits_of(s) - 1); }
inline Bits rotated(Scalar s, Bits a, Bits b) {
    const Bits n = shift_count(s, b);
    return n == 0 ? a : cut(s, a << n | a >> (static_cast<Bits>(bits_of(s)) - n));
}
inline Bits high_product(Scalar s, Bits a, Bits b) {
    __extension__ typedef unsigned __int128 UnsignedWide;
    if (is_signed(s)) return cut_wide(s, wide(s, a) * wide(s, b) >> bits_of(s));
    return cut(s, static_cast<Bits>(static_cast<UnsignedWide>(a) * b >> bits_of(s)));
}
/// A divisor that is neither 0 nor -1.
inline Wide divisor(Scalar s, Bits b) { return static_cast<Wide>((b & (mask_of(s) >> 1)) | 1); }

// Exact results of the number layer (kernels/number/README.md): in double precision, rounded to odd, so that rounding
// them to the format rounds the exact value (S. Boldo, G. Melquiond 2008).

/// x is the rounded value, `rest` has the sign of the exact value - x.
inline double to_odd(double x, double rest) {
    if (rest == 0 || std::bit_cast<std::uint64_t>(x) & 1) return x;
    return std::nextafter(x, std::copysign(std::numeric_limits<double>::infinity(), rest));
}
inline double exact_sum(double a, double b) {
    const double sum = a + b, part = sum - a;
    return to_odd(sum, (a - (sum - part)) + (b - part));
}
inline double exact_quotient(double a, double b) { return to_odd(a / b, -std::fma(a / b, b, -a) * b); }
inline double exact_root(double a) {
    const double root = std::sqrt(std::max(a, 0.0));
    return to_odd(root, -std::fma(root, root, -std::max(a, 0.0)));
}
inline Bits real_bits(const NumberFormat& format, double exact) { return safe_bits(round_to_format(exact, format)); }

template <class Comparison>
Bits holds(const Operands& x, const Comparison& is_true) {
    return is_integer(x.from) ? is_true(wide(x.from, x.a), wide(x.from, x.b)) : is_true(float_of(x.a), float_of(x.b));
}

#define RAYA_RESULT(value) [](const Operands& x) -> Bits { return value; }
#define RAYA_FLOAT(value)                                                                     \
    [](const Operands& x) -> Bits {                                                           \
        [[maybe_unused]] const float a = float_of(x.a), b = float_of(x.b), c = float_of(x.c); \
        return safe_bits(value);                                                              \
    }
#define RAYA_REAL(value)                                                                       \
    [](const Operands& x) -> Bits {                                                            \
        [[maybe_unused]] const double a = float_of(x.a), b = float_of(x.b), c = float_of(x.c); \
        return real_bits(x.format, value);                                                     \
    }
inline constexpr KernelOperation kKernelOperations[] = {
    // In the order of OperationNumber. Where `apply` is null, the interpreter has the operation.
    {Group::kByNumber, "", 0, nullptr},
    {Group::kByNumber, "", 0, nullptr},
    {Group::kByNumber, "", 1, nullptr},
    {Group::kByNumber, "", 1, nullptr},
    {Group::kByNumber, "", 0, nullptr},
    {Group::kByNumber, "", 0, nullptr},
    {Group::kByNumber, "", 1, nullptr},
    {Group::kByNumber, "", 1, nullptr},
    {Group::kByNumber, "shuffle({0}, {1})", 2, nullptr},
    {Group::kByNumber, "select({1}, {0}, {2})", 3, nullptr},
    {Group::kByNumber, "all({0})", 1, nullptr},
    {Group::kByNumber, "any({0})", 1, nullptr},
    {Group::kByNumber, "convert_{T}({0})", 1, RAYA_RESULT(cut_wide(x.to, wide(x.from, x.a)))},
    {Group::kByNumber, "convert_{T}_sat({0})", 1,
     RAYA_RESULT(saturated(x.to, is_integer(x.from) ? wide(x.from, x.a) : static_cast<Wide>(float_of(x.a))))},
    {Group::kByNumber, "safe_{T}(convert_{T}({0}) * ({T})(0x1p-12f))", 1,
     RAYA_RESULT(safe_bits(static_cast<float>(wide(x.from, x.a)) * 0x1p-12F))},
    {Group::kByNumber, "as_{T}({0})", 1, RAYA_RESULT(x.a)},
    {Group::kByNumber, "safe_{T}(as_{T}({0}))", 1, RAYA_RESULT(safe_bits(float_of(x.a)))},
    {Group::kByNumber, "safe_float(num_round({0}))", 1, RAYA_REAL(a)},
    {Group::kByNumber, "safe_float(num_from_index({0} & 0xffffffu))", 1,
     RAYA_RESULT(real_bits(x.format, static_cast<double>(x.a & 0xffffff)))},
    {Group::kByNumber, "{0}", 1, RAYA_RESULT(x.a)},
    {Group::kInteger, "+", 2, RAYA_RESULT(cut(x.to, x.a + x.b))},
    {Group::kInteger, "-", 2, RAYA_RESULT(cut(x.to, x.a - x.b))},
    {Group::kInteger, "*", 2, RAYA_RESULT(cut(x.to, x.a* x.b))},
    {Group::kInteger, "&", 2, RAYA_RESULT(x.a& x.b)},
    {Group::kInteger, "|", 2, RAYA_RESULT(x.a | x.b)},
    {Group::kInteger, "^", 2, RAYA_RESULT(x.a ^ x.b)},
    {Group::kInteger, "(({T})(~{0}))", 1, RAYA_RESULT(cut(x.to, ~x.a))},
    {Group::kInteger, "(({T})({0} << ({1} & ({T})({BITS} - 1))))", 2,
     RAYA_RESULT(cut(x.to, x.a << shift_count(x.to, x.b)))},
    {Group::kInteger, "(({T})({0} >> ({1} & ({T})({BITS} - 1))))", 2,
     RAYA_RESULT(cut_wide(x.to, wide(x.to, x.a) >> shift_count(x.to, x.b)))},
    {Group::kInteger, "(({T})({0} / (({1} & ({T})({MAX})) | ({T})(1))))", 2,
     RAYA_RESULT(cut_wide(x.to, wide(x.to, x.a) / divisor(x.to, x.b)))},
    {Group::kInteger, "(({T})({0} % (({1} & ({T})({MAX})) | ({T})(1))))", 2,
     RAYA_RESULT(cut_wide(x.to, wide(x.to, x.a) % divisor(x.to, x.b)))},
    {Group::kInteger, "min({0}, {1})", 2, RAYA_RESULT(wide(x.to, x.b) < wide(x.to, x.a) ? x.b : x.a)},
    {Group::kInteger, "max({0}, {1})", 2, RAYA_RESULT(wide(x.to, x.a) < wide(x.to, x.b) ? x.b : x.a)},
    {Group::kInteger, "as_{T}(abs({0}))", 1, RAYA_RESULT(wide(x.to, x.a) < 0 ? cut(x.to, 0 - x.a) : x.a)},
    {Group::kInteger, "as_{T}(abs_diff({0}, {1}))", 2,
     RAYA_RESULT(wide(x.to, x.a) < wide(x.to, x.b) ? cut(x.to, x.b - x.a) : cut(x.to, x.a - x.b))},
    {Group::kInteger, "add_sat({0}, {1})", 2, RAYA_RESULT(saturated(x.to, wide(x.to, x.a) + wide(x.to, x.b)))},
    {Group::kInteger, "sub_sat({0}, {1})", 2, RAYA_RESULT(saturated(x.to, wide(x.to, x.a) - wide(x.to, x.b)))},
    {Group::kInteger, "mul_hi({0}, {1})", 2, RAYA_RESULT(high_product(x.to, x.a, x.b))},
    {Group::kInteger, "hadd({0}, {1})", 2, RAYA_RESULT(cut_wide(x.to, (wide(x.to, x.a) + wide(x.to, x.b)) >> 1))},
    {Group::kInteger, "rhadd({0}, {1})", 2, RAYA_RESULT(cut_wide(x.to, (wide(x.to, x.a) + wide(x.to, x.b) + 1) >> 1))},
    {Group::kInteger, "rotate({0}, {1})", 2, RAYA_RESULT(rotated(x.to, x.a, x.b))},
    {Group::kInteger, "clz({0})", 1, RAYA_RESULT(static_cast<Bits>(std::countl_zero(x.a) - (64 - bits_of(x.to))))},
    {Group::kInteger, "popcount({0})", 1, RAYA_RESULT(static_cast<Bits>(std::popcount(x.a)))},
    {Group::kInteger, "bitselect({0}, {1}, {2})", 3, RAYA_RESULT((x.a & ~x.c) | (x.b & x.c))},
    {Group::kFloat, "safe_{T}({0} + {1})", 2, RAYA_FLOAT(a + b)},
    {Group::kFloat, "safe_{T}({0} - {1})", 2, RAYA_FLOAT(a - b)},
    {Group::kFloat, "safe_{T}({0} * {1})", 2, RAYA_FLOAT(a* b)},
    {Group::kFloat, "safe_{T}(fma({0}, {1}, {2}))", 3, RAYA_FLOAT(std::fma(a, b, c))},
    {Group::kFloat, "safe_{T}(-{0})", 1, RAYA_FLOAT(-a)},
    {Group::kFloat, "safe_{T}(fabs({0}))", 1, RAYA_FLOAT(std::abs(a))},
    {Group::kFloat, "safe_{T}(fmin({0}, {1}))", 2, RAYA_FLOAT(std::min(a, b))},
    {Group::kFloat, "safe_{T}(fmax({0}, {1}))", 2, RAYA_FLOAT(std::max(a, b))},
    {Group::kFloat, "safe_{T}(floor({0}))", 1, RAYA_FLOAT(std::floor(a))},
    {Group::kFloat, "safe_{T}(ceil({0}))", 1, RAYA_FLOAT(std::ceil(a))},
    {Group::kFloat, "safe_{T}(trunc({0}))", 1, RAYA_FLOAT(std::trunc(a))},
    {Group::kFloat, "safe_{T}(rint({0}))", 1, RAYA_FLOAT(std::nearbyint(a))},
    {Group::kFloat, "safe_{T}(copysign({0}, {1}))", 2, RAYA_FLOAT(std::copysign(a, b))},
    {Group::kReal, "safe_float(num_add({0}, {1}))", 2, RAYA_REAL(exact_sum(a, b))},
    {Group::kReal, "safe_float(num_sub({0}, {1}))", 2, RAYA_REAL(exact_sum(a, -b))},
    {Group::kReal, "safe_float(num_mul({0}, {1}))", 2, RAYA_REAL(a* b)},
    {Group::kReal, "safe_float(num_div({0}, {1}))", 2, RAYA_REAL(exact_quotient(a, b))},
    {Group::kReal, "safe_float(num_sqrt({0}))", 1, RAYA_REAL(exact_root(a))},
    {Group::kReal, "safe_float(num_mad({0}, {1}, {2}))", 3, RAYA_REAL(exact_sum(a* b, c))},
    {Group::kReal, "safe_float(num_max({0}, {1}))", 2, RAYA_REAL(std::max(a, b))},
    {Group::kReal, "safe_float(num_floor({0}))", 1, RAYA_REAL(std::floor(a))},
    {Group::kCompare, "<", 2, RAYA_RESULT(holds(x, [](auto a, auto b) { return a < b; }))},
    {Group::kCompare, "<=", 2, RAYA_RESULT(holds(x, [](auto a, auto b) { return a <= b; }))},
    {Group::kCompare, "==", 2, RAYA_RESULT(holds(x, [](auto a, auto b) { return a == b; }))},
    {Group::kCompare, "!=", 2, RAYA_RESULT(holds(x, [](auto a, auto b) { return a != b; }))},
};
#undef RAYA_RESULT
#undef RAYA_FLOAT
#undef RAYA_REAL

/// Types of truth values: int for scalars, for vectors the signed integer of the operands' width.
constexpr KernelType truth_of(KernelType operands) {
    return operands.width == 1 ? KernelType{Scalar::kInt, 1}
                               : KernelType{with_sign(operands.scalar, true), operands.width};
}

}  // namespace raya
