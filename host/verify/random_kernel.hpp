// Random OpenCL C kernels without undefined behaviour, and an interpreter that computes their exact results on the
// host. A device that computes other words, its driver or its compiler is wrong (raya verify --random).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/model/number_format.hpp"

namespace raya {

/// A scalar type of the kernels. kReal is a number of the number layer (kernels/number/), stored as a float.
enum class Scalar : std::uint8_t { kChar, kUchar, kShort, kUshort, kInt, kUint, kLong, kUlong, kFloat, kReal };

struct KernelType {
    Scalar scalar = Scalar::kUint;
    int width = 1;  // elements: 1, 2, 3, 4, 8 or 16; 1 for kReal
    bool operator==(const KernelType&) const = default;
};

/// An expression. `operation` is an index into the table of operations (random_operations.hpp).
struct Expression {
    std::size_t operation = 0;
    KernelType type{};
    std::vector<Expression> arguments{};
    std::uint64_t number = 0;  // bits of a constant; index of a variable, function, field or element
    std::size_t object = 0;    // index of a memory object
    std::vector<int> order{};  // elements of a swizzle
};

struct Statement {
    enum Kind {
        kAssign,  // variable `target` = values[0]
        kStore,   // element values[0] of memory object `object`, field `target` = values[1]
        kCopy,    // element values[0] of memory object `object` = element values[1], all fields
        kIf,      // values[0] ? bodies[0] : bodies[1]
        kLoop,    // `count` times bodies[0]; variable `target` counts from 0
        kSwitch,  // values[0] & 3 chooses the body where execution begins; falls_through: at its end, the next follows
        kBreak,   // of the innermost loop, if values[0]
        kContinue,  // of the innermost loop, if values[0]
        kReturn,    // values[1] from the function, if values[0]
        kAtomic,    // counter number `target` combined with values[0]; its operation is that of `target`
        kExchange   // all work-items: store values[0] in the shared object, barrier, variable `target` = field 0 of the
                    // element of the work-item `count` places further, barrier
    };
    Kind kind = kAssign;
    std::size_t target = 0, object = 0;
    int count = 0;
    std::vector<Expression> values{};
    std::vector<std::vector<Statement>> bodies{};
    std::array<bool, 4> falls_through{};
};

/// Memory with elements of a struct type: private with kPrivateElements elements, or local or global with an element
/// for each work-item, which only this work-item accesses, but for Statement::kExchange.
struct MemoryObject {
    enum Space { kPrivate, kLocal, kGlobal } space = kPrivate;
    std::vector<KernelType> fields{};
};

/// A function that a kernel calls: its first variables are its parameters.
struct KernelFunction {
    std::size_t parameters = 0;
    bool is_inlined = true;
    std::vector<KernelType> variables{};
    std::vector<Statement> body{};
    Expression result{};
};

inline constexpr std::size_t kPrivateElements = 8, kInputWords = 64, kCounters = 12, kGlobalElementBytes = 1024;

/// A kernel:
///
///     __kernel void random_kernel(__global const uint* in, __global uint* out, __global uint* counters,
///                                 __global uchar* elements)
///
/// `in` has kInputWords words. `counters`, kCounters words, start with 0; all variables and elements with 0, floats
/// with 1. The first half of the counters are in global memory, the others in local memory until the end. Each
/// work-item writes the words of all its variables, and a word for each memory object, to `out`. `elements`:
/// kGlobalElementBytes for each work-item and memory object.
struct RandomKernel {
    NumberFormat format{};
    std::uint32_t group_size = 1, groups = 1;
    std::vector<MemoryObject> objects{};
    std::vector<KernelFunction>
        functions{};  // a function calls only functions before it; the last is the kernel's body

    std::size_t work_items() const { return std::size_t{group_size} * groups; }
    std::size_t words_per_item() const;
    std::size_t element_bytes() const { return work_items() * objects.size() * kGlobalElementBytes; }
};

/// Number of statements and expressions.
std::size_t size_of(const RandomKernel& kernel);

/// Returns the kernel number `number` of the sequence `seed`, made smaller by each of `changes` (smaller_kernel()).
RandomKernel random_kernel(std::uint64_t seed, std::uint64_t number, const std::vector<std::size_t>& changes = {});

enum class Dialect {
    kOpenCl,  // OpenCL C 1.2, which includes the number layer
    kCpp      // C++, for tests/verify/kernel_as_cpp.hpp
};
std::string source_of(const RandomKernel& kernel, Dialect dialect);

/// Returns the name of word `word` of a work-item, such as "v3.s1".
std::string word_name(const RandomKernel& kernel, std::size_t word);

/// Words of `in` for this kernel number.
std::vector<std::uint32_t> random_input(std::uint64_t seed, std::uint64_t number);

struct KernelResults {
    std::vector<std::uint32_t> out, counters;
    bool operator==(const KernelResults&) const = default;
};

/// Computes the exact results.
KernelResults interpreted(const RandomKernel& kernel, const std::vector<std::uint32_t>& in);

/// Returns the kernel with change number `change`: statements removed, a compound statement replaced by one of its
/// bodies, an expression by an argument of the same type or a constant. Large changes come first. Nothing: there are
/// not so many changes.
std::optional<RandomKernel> smaller_kernel(const RandomKernel& kernel, std::size_t change);

/// Returns changes that make the kernel smaller and with which it still fails: fails(changes, smaller kernel).
std::vector<std::size_t> reducing_changes(
    RandomKernel kernel, const std::function<bool(const std::vector<std::size_t>&, const RandomKernel&)>& fails);

}  // namespace raya
