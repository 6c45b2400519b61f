// The text of a random kernel.
#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/base/encoding.hpp"
#include "host/verify/random_operations.hpp"

namespace raya {
namespace {

using Texts = std::vector<std::string>;

std::string name_of(KernelType type) {
    static constexpr std::array kNames = {"char", "uchar", "short", "ushort", "int",
                                          "uint", "long",  "ulong", "float",  "float"};
    return std::string(kNames.at(static_cast<std::size_t>(type.scalar))) +
           (type.width == 1 ? "" : std::to_string(type.width));
}

/// "v.s3", or "v" for a scalar.
std::string element_text(const std::string& value, KernelType type, int element, Dialect dialect = Dialect::kOpenCl) {
    if (type.width == 1) return value;
    if (dialect == Dialect::kCpp) return fmt::format("swizzle<{}>({})", element, value);
    return fmt::format("{}.s{:x}", value, element);
}

/// The expressions that together have all bits of a value, a uint each.
Texts words_of(const std::string& value, KernelType type, Dialect dialect) {
    Texts words;
    for (int i = 0; i < type.width; ++i) {
        const std::string element = element_text(value, type, i, dialect);
        if (bits_of(type.scalar) == 64)
            for (const char* const shift : {"", " >> 32"})
                words.push_back(fmt::format("(uint)(as_ulong({}){})", element, shift));
        else
            words.push_back(fmt::format("(uint)as_{}({})", name_of({with_sign(type.scalar, false), 1}), element));
    }
    return words;
}

class Printer {
  public:
    Printer(const RandomKernel& kernel, Dialect dialect) : kernel_(kernel), dialect_(dialect) {}

    std::string text() {
        if (dialect_ == Dialect::kOpenCl) line("#include \"kernels/number/number.clh\"");
        for (const int width : {1, 2, 3, 4, 8, 16})
            if (dialect_ == Dialect::kOpenCl)
                print_safe(name_of({Scalar::kFloat, width}), name_of({Scalar::kInt, width}));
        for (std::size_t i = 0; i < kernel_.objects.size(); ++i) {
            line("struct S{} {{", i);
            for (std::size_t f = 0; f < fields(i).size(); ++f) line("    {} f{};", name_of(fields(i)[f]), f);
            line("}};");
        }
        for (std::size_t i = 0; i + 1 < kernel_.functions.size(); ++i) print_function(i);
        print_kernel();
        return text_;
    }

  private:
    template <class... Args>
    void line(fmt::format_string<Args...> format, Args&&... args) {
        text_ += std::string(4 * depth_, ' ') + fmt::format(format, std::forward<Args>(args)...) + "\n";
    }

    const std::vector<KernelType>& fields(std::size_t object) const { return kernel_.objects[object].fields; }

    void print_safe(const std::string& type, const std::string& truth) {
        line(
            "static inline {0} safe_{0}({0} x) {{ {1} ok = (fabs(x) >= ({0})(0x1p-60f)) & (fabs(x) <= "
            "({0})(0x1p60f)); return select(({0})(1.0f), x, ok); }}",
            type, truth);
    }

    std::string constant(KernelType type, Bits bits) const {
        if (!is_integer(type.scalar)) return fmt::format("({:a}f)", float_of(bits));
        const std::string digits = fmt::format("0x{:x}{}", bits, bits_of(type.scalar) == 64 ? "UL" : "u");
        const std::string number = fmt::format("({}){}", name_of({with_sign(type.scalar, false), 1}), digits);
        return is_signed(type.scalar) ? fmt::format("as_{}({})", name_of(type), number) : fmt::format("({})", number);
    }

    std::string element(std::size_t object, const std::string& index) const {
        switch (kernel_.objects[object].space) {
            case MemoryObject::kPrivate:
                return fmt::format("p{}[{} & 7u]", object, index);
            case MemoryObject::kLocal:
                return fmt::format("l{}[lid]", object);
            default:
                return fmt::format("g{}[gid]", object);
        }
    }

    std::string infix(const char* symbol, KernelType type, const Texts& a) const {
        const KernelType plain{with_sign(type.scalar, false), type.width};
        const bool promotes = type.width == 1 && bits_of(type.scalar) < 32;
        const auto operand = [&](const std::string& text) {
            const std::string cast = is_signed(type.scalar) ? fmt::format("as_{}({})", name_of(plain), text) : text;
            return promotes ? "(uint)" + cast : cast;
        };
        std::string text = fmt::format("({} {} {})", operand(a[0]), symbol, operand(a[1]));
        if (promotes) text = fmt::format("({}){}", name_of(plain), text);
        return is_signed(type.scalar) ? fmt::format("as_{}({})", name_of(type), text) : fmt::format("({})", text);
    }

    std::string pattern(const char* text, KernelType type, const Texts& a) const {
        const bool is_long = bits_of(type.scalar) == 64;
        std::string all = text;
        for (const auto& [mark, value] :
             {std::pair<const char*, std::string>{"{T}", name_of(type)},
              {"{BITS}", std::to_string(bits_of(type.scalar))},
              {"{MAX}", fmt::format("0x{:x}{}", mask_of(type.scalar) >> 1, is_long ? "L" : "")}})
            all = replaced(all, mark, value);
        for (std::size_t i = a.size(); i-- > 0;) all = replaced(all, fmt::format("{{{}}}", i), a[i]);
        return all;
    }

    std::string made(KernelType type, const Texts& elements) const {
        const char* const format = dialect_ == Dialect::kOpenCl ? "(({})({}))" : "made<{}>({})";
        return fmt::format(fmt::runtime(format), name_of(type), fmt::join(elements, ", "));
    }

    std::string swizzle(const std::string& value, const std::vector<int>& order) const {
        if (dialect_ == Dialect::kCpp) return fmt::format("swizzle<{}>({})", fmt::join(order, ", "), value);
        return fmt::format("({}).s{:x}", value, fmt::join(order, ""));
    }

    std::string expression(const Expression& e) const {
        Texts a;
        for (const Expression& argument : e.arguments) a.push_back(expression(argument));
        const auto& [group, text, arguments, apply] = kKernelOperations[e.operation];
        const bool is_scalar = e.type.width == 1;
        if (group == Group::kCompare) return fmt::format("{}({} {} {})", is_scalar ? "(int)" : "", a[0], text, a[1]);
        if (group == Group::kInteger && text[1] == '\0') return infix(text, e.type, a);
        switch (e.operation) {
            case kConstant:
                return constant(e.type, e.number);
            case kVariable:
                return fmt::format("v{}", e.number);
            case kInput:
                return fmt::format("in[({} + gid) & {}u]", a[0], kInputWords - 1);
            case kElement:
                return fmt::format("{}.f{}", element(e.object, a[0]), e.number);
            case kCallFunction:
                return fmt::format("f{}({})", e.number, fmt::join(a, ", "));
            case kSwizzle:
                return swizzle(a[0], e.order);
            case kMake:
            case kSpread:
                return made(e.type, a);
            default:
                return pattern(e.operation == kSelect && is_scalar ? "(({T})({2} ? {0} : {1}))" : text, e.type, a);
        }
    }

    void print_block(const std::vector<Statement>& statements) {
        ++depth_;
        for (const Statement& s : statements) print(s);
        --depth_;
    }

    void print(const Statement& s) {
        Texts v;
        for (const Expression& value : s.values) v.push_back(expression(value));
        switch (s.kind) {
            case Statement::kAssign:
                return line("v{} = {};", s.target, v[0]);
            case Statement::kStore:
                return line("{}.f{} = {};", element(s.object, v[0]), s.target, v[1]);
            case Statement::kCopy:
                return line("{} = {};", element(s.object, v[0]), element(s.object, v[1]));
            case Statement::kBreak:
                return line("if ({}) break;", v[0]);
            case Statement::kContinue:
                return line("if ({}) continue;", v[0]);
            case Statement::kReturn:
                return line("if ({}) return {};", v[0], v[1]);
            case Statement::kAtomic: {
                const bool is_local = s.target >= kCounters / 2;
                return line("atomic_{}(&{}[{}], {});", counter_operation(s.target),
                            is_local ? "local_counters" : "counters", s.target % (kCounters / 2), v[0]);
            }
            case Statement::kExchange:
                return print_exchange(s, v[0]);
            case Statement::kIf:
                line("if ({}) {{", v[0]);
                print_block(s.bodies[0]);
                line("}} else {{");
                print_block(s.bodies[1]);
                return line("}}");
            case Statement::kLoop:
                line("for (v{0} = 0; v{0} < {1}; ++v{0}) {{", s.target, s.count);
                print_block(s.bodies[0]);
                return line("}}");
            case Statement::kSwitch:
                line("switch ({} & 3u) {{", v[0]);
                for (std::size_t i = 0; i < s.bodies.size(); ++i) {
                    line("{}:", i + 1 < s.bodies.size() ? fmt::format("case {}", i) : "default");
                    print_block(s.bodies[i]);
                    if (!s.falls_through[i]) line("    break;");
                }
                return line("}}");
        }
    }

    void print_exchange(const Statement& s, const std::string& value) {
        const bool is_local = kernel_.objects[s.object].space == MemoryObject::kLocal;
        const char* const barrier = is_local ? "barrier(CLK_LOCAL_MEM_FENCE);" : "barrier(CLK_GLOBAL_MEM_FENCE);";
        const std::string other = fmt::format("(lid + {}u) % {}u", s.count, kernel_.group_size);
        line("{}.f0 = {};", element(s.object, ""), value);
        line("{}", barrier);
        if (is_local)
            line("v{} = l{}[{}].f0;", s.target, s.object, other);
        else
            line("v{} = g{}[gid - lid + {}].f0;", s.target, s.object, other);
        line("{}", barrier);
    }

    static const char* counter_operation(std::size_t counter) {
        static constexpr std::array kOperations = {"add", "sub", "xor", "or", "max", "add"};
        return kOperations.at(counter % kOperations.size());
    }

    void print_variables(const KernelFunction& f) {
        for (std::size_t i = f.parameters; i < f.variables.size(); ++i)
            line("{0} v{1} = ({0})({2});", name_of(f.variables[i]), i, start_of(f.variables[i].scalar) ? 1 : 0);
    }

    void print_function(std::size_t number) {
        const KernelFunction& f = kernel_.functions[number];
        Texts parameters;
        for (std::size_t i = 0; i < f.parameters; ++i)
            parameters.push_back(fmt::format("{} v{}", name_of(f.variables[i]), i));
        line("{} {} f{}({}) {{", f.is_inlined ? "static inline" : "__attribute__((noinline)) static",
             name_of(f.result.type), number, fmt::join(parameters, ", "));
        ++depth_;
        print_variables(f);
        --depth_;
        print_block(f.body);
        line("    return {};", expression(f.result));
        line("}}");
    }

    void print_kernel() {
        line(
            "__kernel void random_kernel(__global const uint* in, __global uint* out, __global uint* counters, "
            "__global uchar* elements) {{");
        ++depth_;
        line("const uint lid = (uint)get_local_id(0), gid = (uint)get_global_id(0);");
        line("{} uint local_counters[{}];", space_name(MemoryObject::kLocal), kCounters / 2);
        line("if (lid == 0) for (uint i = 0; i < {}; ++i) local_counters[i] = 0;", kCounters / 2);
        for (std::size_t i = 0; i < kernel_.objects.size(); ++i) print_object(i);
        print_variables(kernel_.functions.back());
        line("barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);");
        --depth_;
        print_block(kernel_.functions.back().body);
        ++depth_;
        line("barrier(CLK_LOCAL_MEM_FENCE);");
        line("if (lid == 0) {{");
        for (std::size_t i = 0; i < kCounters / 2; ++i) {
            const std::string operation = counter_operation(i);
            line("    atomic_{}(&counters[{}], local_counters[{}]);", operation == "sub" ? "add" : operation,
                 kCounters / 2 + i, i);
        }
        line("}}");
        print_results();
        --depth_;
        line("}}");
    }

    const char* space_name(MemoryObject::Space space) const {
        if (space == MemoryObject::kPrivate) return "";
        if (dialect_ == Dialect::kCpp) return space == MemoryObject::kLocal ? "static" : "";
        return space == MemoryObject::kLocal ? "__local" : "__global";
    }

    void print_object(std::size_t i) {
        const MemoryObject::Space space = kernel_.objects[i].space;
        std::string element;
        if (space == MemoryObject::kPrivate) {
            line("struct S{0} p{0}[{1}];", i, kPrivateElements);
            element = fmt::format("for (uint i = 0; i < {}; ++i) p{}[i]", kPrivateElements, i);
        } else if (space == MemoryObject::kLocal) {
            line("{0} struct S{1} l{1}[{2}];", space_name(space), i, kernel_.group_size);
            element = fmt::format("l{}[lid]", i);
        } else {
            line("{0} struct S{1}* g{1} = ({0} struct S{1}*)(elements + {2});", space_name(space), i,
                 i * kernel_.work_items() * kGlobalElementBytes);
            element = fmt::format("g{}[gid]", i);
        }
        for (std::size_t f = 0; f < fields(i).size(); ++f)
            line("{}.f{} = ({})({});", element, f, name_of(fields(i)[f]), start_of(fields(i)[f].scalar) ? 1 : 0);
    }

    void print_results() {
        line("__global uint* o = out + gid * {};", kernel_.words_per_item());
        std::size_t at = 0;
        const KernelFunction& f = kernel_.functions.back();
        for (std::size_t i = 0; i < f.variables.size(); ++i)
            for (const std::string& word : words_of(fmt::format("v{}", i), f.variables[i], dialect_))
                line("o[{}] = {};", at++, word);
        for (std::size_t i = 0; i < kernel_.objects.size(); ++i) {
            const bool is_private = kernel_.objects[i].space == MemoryObject::kPrivate;
            line("{{");
            line("    uint h = 0;");
            line("    for (uint i = 0; i < {}; ++i) {{", is_private ? kPrivateElements : 1);
            for (std::size_t k = 0; k < fields(i).size(); ++k)
                for (const std::string& word :
                     words_of(fmt::format("{}.f{}", element(i, "i"), k), fields(i)[k], dialect_))
                    line("        h = h * 31u + {};", word);
            line("    }}");
            line("    o[{}] = h;", at++);
            line("}}");
        }
    }

    const RandomKernel& kernel_;
    Dialect dialect_;
    std::string text_;
    std::size_t depth_ = 0;
};

std::size_t words_of_type(KernelType type) {
    return static_cast<std::size_t>(type.width) * (bits_of(type.scalar) == 64 ? 2 : 1);
}

}  // namespace

std::size_t RandomKernel::words_per_item() const {
    std::size_t words = objects.size();
    for (const KernelType type : functions.back().variables) words += words_of_type(type);
    return words;
}

std::string word_name(const RandomKernel& kernel, std::size_t word) {
    const std::vector<KernelType>& variables = kernel.functions.back().variables;
    for (std::size_t i = 0; i < variables.size(); word -= words_of_type(variables[i++]))
        if (word < words_of_type(variables[i])) {
            const bool is_long = bits_of(variables[i].scalar) == 64;
            return element_text(fmt::format("v{}", i), variables[i], static_cast<int>(word) / (is_long ? 2 : 1)) +
                   (!is_long        ? ""
                    : word % 2 == 0 ? ", lower half"
                                    : ", upper half");
        }
    return fmt::format("sum of the elements of memory object {}", word);
}

std::string source_of(const RandomKernel& kernel, Dialect dialect) { return Printer(kernel, dialect).text(); }

}  // namespace raya
