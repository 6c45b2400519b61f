// The part of OpenCL C that random kernels use, for a C++ compiler: a second opinion on the interpreter of
// host/verify/random_kernel.hpp. Written from the OpenCL C 1.2 specification, without code of raya.
#pragma once
#include <ucontext.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#define __kernel static
#define __global
#define CLK_LOCAL_MEM_FENCE 1
#define CLK_GLOBAL_MEM_FENCE 2
#pragma GCC diagnostic ignored "-Wunused-function"

typedef unsigned char uchar;
typedef unsigned short ushort;
typedef unsigned int uint;
typedef unsigned long ulong;

template <class T, int N>
struct Vec {
    T e[N == 3 ? 4 : N] = {};
    Vec() = default;
    explicit Vec(T x) {
        for (T& element : e) element = x;
    }
};

template <class A>
struct Parts {
    using Element = A;
    static constexpr int kWidth = 1;
    static A& at(A& a, int) { return a; }
};
template <class T, int N>
struct Parts<Vec<T, N>> {
    using Element = T;
    static constexpr int kWidth = N;
    static T& at(Vec<T, N>& a, int i) { return a.e[i]; }
};
template <class T, int N>
using Wide = std::conditional_t<N == 1, T, Vec<T, N>>;
template <class A>
using Element = typename Parts<A>::Element;
template <class A>
constexpr int kWidth = Parts<A>::kWidth;
template <class A>
Element<A>& at(A& a, int i) {
    return Parts<A>::at(a, i);
}

template <class R, class F, class... A>
R each(F f, A... a) {
    R r{};
    for (int i = 0; i < kWidth<R>; ++i) at(r, i) = static_cast<Element<R>>(f(at(a, i)...));
    return r;
}
template <int Bytes>
using Truth = std::conditional_t<Bytes == 1, char,
                                 std::conditional_t<Bytes == 2, short, std::conditional_t<Bytes == 4, int, long>>>;

#define OPERATOR(op)                                                                   \
    template <class T, int N>                                                          \
    Vec<T, N> operator op(Vec<T, N> a, Vec<T, N> b) {                                  \
        return each<Vec<T, N>>([](T x, T y) { return static_cast<T>(x op y); }, a, b); \
    }
OPERATOR(&)
OPERATOR(|)
OPERATOR(^) OPERATOR(<<) OPERATOR(>>) OPERATOR(/) OPERATOR(%)
#undef OPERATOR
// Sums and products of ushort in unsigned arithmetic: those of int overflow.
#define ARITHMETIC(op)                                                                                                 \
    template <class T, int N>                                                                                          \
    Vec<T, N> operator op(Vec<T, N> a, Vec<T, N> b) {                                                                  \
        using W = std::conditional_t<std::is_floating_point_v<T>, T, std::conditional_t<sizeof(T) == 8, ulong, uint>>; \
        return each<Vec<T, N>>([](T x, T y) { return static_cast<T>(static_cast<W>(x) op static_cast<W>(y)); }, a, b); \
    }
    ARITHMETIC(+) ARITHMETIC(-) ARITHMETIC(*)
#undef ARITHMETIC
#define COMPARE(op)                                                                            \
    template <class T, int N>                                                                  \
    Vec<Truth<sizeof(T)>, N> operator op(Vec<T, N> a, Vec<T, N> b) {                           \
        return each<Vec<Truth<sizeof(T)>, N>>([](T x, T y) { return x op y ? -1 : 0; }, a, b); \
    }
        COMPARE(<) COMPARE(<=) COMPARE(==) COMPARE(!=)
#undef COMPARE
            template <class T, int N>
            Vec<T, N> operator~(Vec<T, N> a) {
    return each<Vec<T, N>>([](T x) { return static_cast<T>(~x); }, a);
}
template <class T, int N>
Vec<T, N> operator-(Vec<T, N> a) {
    return each<Vec<T, N>>([](T x) { return static_cast<T>(-x); }, a);
}

template <class V, class... A>
V made(A... a) {
    if constexpr (sizeof...(A) == 1) {
        return V((a, ...));
    } else {
        V v;
        int i = 0;
        ((v.e[i++] = a), ...);
        return v;
    }
}
template <int... Order, class V>
auto swizzle(V v) {
    Wide<Element<V>, sizeof...(Order)> r{};
    int i = 0;
    ((at(r, i++) = v.e[Order]), ...);
    return r;
}
template <class T, int N, class U, int M>
Vec<T, M> shuffle(Vec<T, N> v, Vec<U, M> order) {
    return each<Vec<T, M>>([&](U i) { return v.e[i & (N - 1)]; }, order);
}

template <class R, class A>
R bits_as(A a) {
    R r{};
    static_assert(sizeof r <= sizeof a);
    std::memcpy(&r, &a, sizeof r);
    return r;
}
__extension__ typedef __int128 Integer128;
template <class T, class A>
T saturated(A x) {
    constexpr T kMin = std::is_signed_v<T> ? T(T(1) << (8 * sizeof(T) - 1)) : T(0), kMax = T(~kMin);
    if constexpr (std::is_floating_point_v<A>) {
        const long double wide = std::trunc(static_cast<long double>(x));
        return wide <= kMin ? kMin : wide >= kMax ? kMax : static_cast<T>(wide);
    } else {
        return Integer128{x} < Integer128{kMin} ? kMin : Integer128{x} > Integer128{kMax} ? kMax : static_cast<T>(x);
    }
}
template <class R, class A>
R safe(A a) {
    return each<R>([](float x) { return std::fabs(x) >= 0x1p-60f && std::fabs(x) <= 0x1p60f ? x : 1.0f; }, a);
}

#define WIDTH(type, n)            \
    using type##n = Vec<type, n>; \
    TYPE(type##n, type)
#define TYPE(name, element)                                                   \
    template <class A>                                                        \
    name as_##name(A a) {                                                     \
        return bits_as<name>(a);                                              \
    }                                                                         \
    template <class A>                                                        \
    name convert_##name(A a) {                                                \
        return each<name>([](auto x) { return static_cast<element>(x); }, a); \
    }                                                                         \
    template <class A>                                                        \
    name convert_##name##_sat(A a) {                                          \
        return each<name>([](auto x) { return saturated<element>(x); }, a);   \
    }
#define TYPES(type) TYPE(type, type) WIDTH(type, 2) WIDTH(type, 3) WIDTH(type, 4) WIDTH(type, 8) WIDTH(type, 16)
TYPES(char)
TYPES(uchar) TYPES(short) TYPES(ushort) TYPES(int) TYPES(uint) TYPES(long) TYPES(ulong) TYPES(float)
#undef TYPE
#define TYPE(name, element) \
    inline name safe_##name(name a) { return safe<name>(a); }
    TYPE(float, float) TYPE(float2, ) TYPE(float3, ) TYPE(float4, ) TYPE(float8, ) TYPE(float16, )
#undef TYPE

        template <class A>
        A select(A a, A b, Wide<Truth<sizeof(Element<A>)>, kWidth<A>> c) {
    return each<A>([](auto x, auto y, auto z) { return z < 0 ? y : x; }, a, b, c);
}
template <class T, int N>
int all(Vec<T, N> a) {
    int r = 1;
    for (int i = 0; i < N; ++i) r &= a.e[i] < 0;
    return r;
}
template <class T, int N>
int any(Vec<T, N> a) {
    int r = 0;
    for (int i = 0; i < N; ++i) r |= a.e[i] < 0;
    return r;
}

#define FUNCTION1(name, body)          \
    template <class A>                 \
    A name(A a) {                      \
        return each<A>(                \
            [](auto x) {               \
                using T = decltype(x); \
                (void)sizeof(T);       \
                body                   \
            },                         \
            a);                        \
    }
#define FUNCTION2(name, body)          \
    template <class A>                 \
    A name(A a, A b) {                 \
        return each<A>(                \
            [](auto x, auto y) {       \
                using T = decltype(x); \
                (void)sizeof(T);       \
                body                   \
            },                         \
            a, b);                     \
    }
template <class T>
T product_high(T x, T y) {
    if constexpr (sizeof(T) == 8) {  // by halves
        const auto ux = static_cast<ulong>(x), uy = static_cast<ulong>(y);
        const ulong low = (ux & 0xffffffff) * (uy & 0xffffffff), a = (ux >> 32) * (uy & 0xffffffff) + (low >> 32),
                    b = (ux & 0xffffffff) * (uy >> 32) + (a & 0xffffffff);
        ulong high = (ux >> 32) * (uy >> 32) + (a >> 32) + (b >> 32);
        if (x < 0) high -= uy;
        if (y < 0) high -= ux;
        return static_cast<T>(high);
    } else {
        return static_cast<T>(static_cast<long>(x) * static_cast<long>(y) >> (8 * sizeof(T)));
    }
}
template <class T>
int leading_zeros(T x) {
    int n = 0;
    for (int bit = 8 * sizeof(T) - 1; bit >= 0 && !(x >> bit & 1); --bit) ++n;
    return n;
}
FUNCTION2(min, return y < x ? y : x;)
FUNCTION2(max, return x < y ? y : x;)
FUNCTION1(abs, return static_cast<T>(x < 0 ? T(0) - static_cast<std::make_unsigned_t<T>>(x) : x);)
FUNCTION2(abs_diff, using U = std::make_unsigned_t<T>; return static_cast<T>(x > y ? U(x) - U(y) : U(y) - U(x));)
FUNCTION2(add_sat, T r; return __builtin_add_overflow(x, y, &r)
                                   ? (y < 0                 ? T(T(1) << (8 * sizeof(T) - 1))
                                      : std::is_signed_v<T> ? T(~T(T(1) << (8 * sizeof(T) - 1)))
                                                            : T(~T(0)))
                                   : r;)
FUNCTION2(sub_sat, T r; return __builtin_sub_overflow(x, y, &r) ? (!std::is_signed_v<T> ? T(0)
                                                                   : y > 0              ? T(T(1) << (8 * sizeof(T) - 1))
                                                                           : T(~T(T(1) << (8 * sizeof(T) - 1))))
                                                                : r;)
FUNCTION2(mul_hi, return product_high(x, y);)
FUNCTION2(hadd, return static_cast<T>((x >> 1) + (y >> 1) + (x & y & 1));)
FUNCTION2(rhadd, return static_cast<T>((x >> 1) + (y >> 1) + ((x | y) & 1));)
FUNCTION2(rotate, using U = std::make_unsigned_t<T>; constexpr int kBits = 8 * sizeof(T);
          const int n = static_cast<int>(U(y) & (kBits - 1));
          return static_cast<T>(n ? U(U(x) << n) | U(U(x) >> (kBits - n)) : U(x));)
FUNCTION1(clz, return static_cast<T>(leading_zeros(x));)
FUNCTION1(popcount, int n = 0; for (unsigned bit = 0; bit < 8 * sizeof(T); ++bit) n += static_cast<int>(x >> bit & 1);
          return static_cast<T>(n);)
template <class A>
A bitselect(A a, A b, A c) {
    return each<A>([](auto x, auto y, auto z) { return (x & ~z) | (y & z); }, a, b, c);
}
#define FLOAT1(name)                                                         \
    template <int N>                                                         \
    Vec<float, N> name(Vec<float, N> a) {                                    \
        return each<Vec<float, N>>([](float x) { return std::name(x); }, a); \
    }
#define FLOAT2(name)                                                                        \
    template <int N>                                                                        \
    Vec<float, N> name(Vec<float, N> a, Vec<float, N> b) {                                  \
        return each<Vec<float, N>>([](float x, float y) { return std::name(x, y); }, a, b); \
    }
FLOAT1(fabs)
FLOAT1(floor)
FLOAT1(ceil) FLOAT1(trunc) FLOAT1(rint) FLOAT2(fmin) FLOAT2(fmax) FLOAT2(copysign) using std::fmin, std::fmax,
    std::fabs, std::floor, std::ceil, std::trunc, std::rint, std::copysign, std::fma;
template <int N>
Vec<float, N> fma(Vec<float, N> a, Vec<float, N> b, Vec<float, N> c) {
    return each<Vec<float, N>>([](float x, float y, float z) { return std::fma(x, y, z); }, a, b, c);
}

// The number layer in quadruple precision, rounded to the format of the current kernel.
__extension__ typedef __float128 Quad;
static int exponent_bits, fraction_bits, truncates;
static float rounded(Quad exact) {
    const bool negative = exact < 0;
    Quad m = negative ? -exact : exact;
    if (m == 0) return 0;
    int exponent = 0;
    for (; m >= 2; m /= 2) ++exponent;
    for (; m < 1; m *= 2) --exponent;
    for (int i = 0; i < fraction_bits; ++i) m *= 2;
    auto units = static_cast<ulong>(m);
    const Quad rest = m - static_cast<Quad>(units);
    if (!truncates && (rest > 0.5 || (rest == 0.5 && units % 2))) ++units;
    const double value = std::ldexp(static_cast<double>(units), exponent - fraction_bits);
    const int top = (1 << (exponent_bits - 1)) - 1;
    const double largest = std::ldexp(2 - std::ldexp(1, -fraction_bits), top);
    const double result = value > largest ? largest : value < std::ldexp(1, 1 - top) ? 0 : value;
    return static_cast<float>(negative ? -result : result);
}
static float num_round(float a) { return rounded(a); }
static float num_from_index(uint a) { return rounded(a); }
static float num_add(float a, float b) { return rounded(Quad(a) + b); }
static float num_sub(float a, float b) { return rounded(Quad(a) - b); }
static float num_mul(float a, float b) { return rounded(Quad(a) * b); }
static float num_div(float a, float b) { return rounded(Quad(a) / b); }
static float num_mad(float a, float b, float c) { return rounded(Quad(a) * b + c); }
static float num_max(float a, float b) { return a > b ? a : b; }
static float num_floor(float a) { return std::floor(a); }
static float num_sqrt(float a) {
    if (a <= 0) return 0;
    Quad root = std::sqrt(static_cast<double>(a));
    for (int i = 0; i < 3; ++i) root = (root + a / root) / 2;  // Newton, to the last bits of a Quad
    return rounded(root);
}

static void atomic_add(uint* p, uint x) { *p += x; }
static void atomic_sub(uint* p, uint x) { *p -= x; }
static void atomic_xor(uint* p, uint x) { *p ^= x; }
static void atomic_or(uint* p, uint x) { *p |= x; }
static void atomic_max(uint* p, uint x) { *p = *p > x ? *p : x; }

// The work-items of a group run in turns up to the next barrier.
static ucontext_t scheduler;
struct WorkItem {
    ucontext_t context;
    std::vector<char> stack = std::vector<char>(1 << 18);
    bool done = false;
};
static std::vector<WorkItem> work_items;
static uint current_item, current_group, group_size;
static uint get_local_id(int) { return current_item; }
static uint get_global_id(int) { return current_group * group_size + current_item; }
static void barrier(int) { swapcontext(&work_items[current_item].context, &scheduler); }

using KernelEntry = void (*)(const uint*, uint*, uint*, uchar*);
static KernelEntry entry;
static const uint* kernel_in;
static uint *kernel_out, *kernel_counters;
static uchar* kernel_elements;
static void run_item() {
    entry(kernel_in, kernel_out, kernel_counters, kernel_elements);
    work_items[current_item].done = true;
}

/// Runs the kernel and prints the words of `out` and the counters.
static void run_kernel(KernelEntry kernel, uint groups, uint size, uint words, uint element_bytes, int exponents,
                       int fractions, int truncate, const std::vector<uint>& in) {
    std::vector<uint> out(words), counters(12);
    std::vector<uchar> elements(element_bytes + 128);
    entry = kernel, group_size = size, kernel_in = in.data(), kernel_out = out.data(),
    kernel_counters = counters.data();
    kernel_elements = elements.data() + (128 - reinterpret_cast<std::size_t>(elements.data()) % 128);
    exponent_bits = exponents, fraction_bits = fractions, truncates = truncate;
    for (current_group = 0; current_group < groups; ++current_group) {
        work_items.assign(size, {});
        for (WorkItem& item : work_items) {
            getcontext(&item.context);
            item.context.uc_stack.ss_sp = item.stack.data();
            item.context.uc_stack.ss_size = item.stack.size();
            item.context.uc_link = &scheduler;
            makecontext(&item.context, run_item, 0);
        }
        for (bool runs = true; runs;) {
            runs = false;
            for (current_item = 0; current_item < size; ++current_item) {
                if (work_items[current_item].done) continue;
                swapcontext(&scheduler, &work_items[current_item].context);
                runs = true;
            }
        }
    }
    for (const uint word : out) std::printf("%08x ", word);
    for (const uint word : counters) std::printf("%08x ", word);
    std::printf("\n");
}
