// The generator of random kernels.
#include "host/scene/split_mix.hpp"
#include "host/verify/random_operations.hpp"

namespace raya {
namespace {

class Generator {
  public:
    explicit Generator(std::uint64_t seed) : random_(seed) {}

    RandomKernel kernel() {
        kernel_.group_size = one_of<std::uint32_t>({1, 2, 3, 4, 5, 7, 8, 12, 16});
        kernel_.groups = static_cast<std::uint32_t>(1 + below(4));
        kernel_.format = one_of<NumberFormat>({{}, {6, 15}, {5, 10}, {8, 7}, {6, 15, true}, {7, 12}});
        for (const auto space : {MemoryObject::kPrivate, MemoryObject::kLocal, MemoryObject::kGlobal}) {
            if (chance(0.3)) continue;
            MemoryObject object{space, {}};
            for (std::size_t fields = 1 + below(3); fields > 0; --fields) object.fields.push_back(type());
            kernel_.objects.push_back(object);
        }
        for (std::size_t functions = below(3); functions > 0; --functions) {
            start_function(below(4));
            function().is_inlined = chance(0.5);
            const KernelType result = type();
            returned_ = &result;
            function().body = block(2 + below(3), {});
            function().result = expression(result, 3);
            returned_ = nullptr;
            ++complete_;
        }
        is_kernel_ = true;
        start_function(0);
        // Variables start with the input, so that no compiler knows them.
        std::vector<Statement> body;
        for (std::size_t i = 0; i < function().variables.size(); ++i)
            body.push_back(assignment(i, input(function().variables[i])));
        for (Statement& s : block(3 + below(5), {.is_uniform = true})) body.push_back(std::move(s));
        function().body = std::move(body);
        return std::move(kernel_);
    }

  private:
    struct Place {
        bool is_uniform = false;   // all work-items of a group come here equally often
        bool leaves_loop = false;  // break and continue are allowed
        int depth = 0;
    };

    std::size_t below(std::size_t n) { return random_.next() % n; }
    bool chance(double p) { return random_.uniform(0, 1) < p; }
    template <class T>
    const T& one_of(const std::vector<T>& values) {
        return values[below(values.size())];
    }
    template <class T>
    T one_of(std::initializer_list<T> values) {
        return values.begin()[below(values.size())];
    }

    KernelType type() {
        const auto scalar = static_cast<Scalar>(chance(0.3) ? 8 + below(2) : below(8));
        if (scalar == Scalar::kReal) return {scalar, 1};
        return {scalar, one_of({1, 1, 1, 1, 1, 1, 2, 2, 3, 4, 4, 8, 16})};
    }

    KernelFunction& function() { return kernel_.functions.back(); }
    void start_function(std::size_t parameters) {
        kernel_.functions.push_back({.parameters = parameters});
        loop_variables_.clear();
        for (std::size_t i = parameters + 2 + below(4); i > 0; --i) function().variables.push_back(type());
    }

    Expression make(std::size_t operation, KernelType type, std::vector<Expression> arguments,
                    std::uint64_t number = 0) {
        return {.operation = operation, .type = type, .arguments = std::move(arguments), .number = number};
    }

    Expression constant(KernelType type) {
        if (type.width > 1) return make(kSpread, type, {constant({type.scalar, 1})});
        Bits bits = random_.next();
        if (!is_integer(type.scalar)) {
            const auto fraction = static_cast<float>(random_.uniform(-2, 2));
            bits =
                safe_bits(std::ldexp(chance(0.5) ? std::round(fraction) : fraction, static_cast<int>(below(17)) - 8));
            if (type.scalar == Scalar::kReal) bits = safe_bits(round_to_format(float_of(bits), kernel_.format));
        } else if (chance(0.6)) {
            bits = one_of<Bits>({0, 1, 2, 7, 31, ~Bits{0}, mask_of(type.scalar) >> 1, (mask_of(type.scalar) >> 1) + 1});
        }
        return make(kConstant, type, {}, cut(type.scalar, bits));
    }

    /// A value of the type made of words of the input.
    Expression input(KernelType type) {
        const auto word = [&] { return make(kInput, {Scalar::kUint, 1}, {constant({Scalar::kUint, 1})}); };
        if (type.width > 1) {
            std::vector<Expression> elements;
            for (int i = 0; i < type.width; ++i) elements.push_back(input({type.scalar, 1}));
            return make(kMake, type, elements);
        }
        if (type.scalar == Scalar::kReal) return make(kRealOf, type, {input({Scalar::kFloat, 1})});
        if (type.scalar == Scalar::kFloat) return make(kToFloat, type, {input({Scalar::kInt, 1})});
        if (type.scalar == Scalar::kUint) return word();
        const Expression converted = make(kConvert, {with_sign(type.scalar, false), 1}, {word()});
        return is_signed(type.scalar) ? make(kBitsOf, type, {converted}) : converted;
    }

    std::vector<std::size_t> variables_of(KernelType type, bool assignable = false) {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < function().variables.size(); ++i)
            if (function().variables[i] == type && !(assignable && std::ranges::count(loop_variables_, i) > 0))
                found.push_back(i);
        return found;
    }

    /// A value of the type made of a variable of another type.
    Expression converted(KernelType type, std::size_t variable) {
        const KernelType from = function().variables[variable];
        Expression value = make(kVariable, from, {}, variable);
        if (from.width != type.width) {
            const bool is_scalar = from.width == 1;
            value = make(is_scalar ? kSpread : kSwizzle, {from.scalar, type.width}, {value});
            if (from.scalar == Scalar::kReal) value.type.scalar = Scalar::kFloat;
            for (int i = 0; i < type.width && !is_scalar; ++i)
                value.order.push_back(static_cast<int>(below(static_cast<std::size_t>(from.width))));
        }
        const Scalar scalar = value.type.scalar;
        const KernelType as_float{Scalar::kFloat, type.width};
        if (scalar == Scalar::kReal && type.scalar != Scalar::kReal) value = make(kFloatOfReal, as_float, {value});
        if (is_integer(type.scalar)) return make(is_integer(scalar) ? kConvert : kSaturate, type, {value});
        if (is_integer(scalar)) value = make(kToFloat, as_float, {value});
        return type.scalar == Scalar::kReal && value.type.scalar != Scalar::kReal ? make(kRealOf, type, {value})
                                                                                  : value;
    }

    Expression leaf(KernelType type) {
        const std::vector<std::size_t> variables = variables_of(type);
        if (!variables.empty() && chance(0.8)) return make(kVariable, type, {}, one_of(variables));
        if (is_kernel_ && chance(0.5))
            for (std::size_t o = 0; o < kernel_.objects.size(); ++o)
                for (std::size_t f = 0; f < kernel_.objects[o].fields.size(); ++f)
                    if (kernel_.objects[o].fields[f] == type && chance(0.7)) {
                        Expression e = make(kElement, type, {constant({Scalar::kUint, 1})}, f);
                        e.object = o;
                        return e;
                    }
        if (chance(0.2)) return is_kernel_ ? input(type) : constant(type);
        return converted(type, below(function().variables.size()));
    }

    Expression condition(int depth) { return expression({Scalar::kInt, 1}, depth); }

    KernelType with_width(int width, bool integer = true) {
        return {static_cast<Scalar>(below(integer ? 8 : 9)), width};
    }

    /// An operation of the group, whose arguments all have the type `operands`.
    Expression of_group(Group group, KernelType result, KernelType operands, int depth) {
        std::size_t operation = 0;
        while (kKernelOperations[operation].group != group) operation = below(std::size(kKernelOperations));
        std::vector<Expression> arguments;
        for (int i = 0; i < kKernelOperations[operation].arguments; ++i)
            arguments.push_back(expression(operands, depth - 1));
        if (group == Group::kCompare && is_integer(operands.scalar) && chance(0.3)) {  // numbers that are often equal
            const Expression three = make(kConstant, {operands.scalar, 1}, {}, 3);
            for (Expression& a : arguments)
                a = make(kAnd, operands, {a, operands.width == 1 ? three : make(kSpread, operands, {three})});
        }
        return make(operation, result, arguments);
    }

    Expression expression(KernelType t, int depth) {
        if (depth <= 0 || chance(0.25)) return leaf(t);
        const auto argument = [&](KernelType type) { return expression(type, depth - 1); };
        for (;;) switch (below(14)) {
                case 0:
                case 1:
                case 2:
                case 3:
                    if (t.scalar == Scalar::kReal) return of_group(Group::kReal, t, t, depth);
                    if (t.scalar == Scalar::kFloat) return of_group(Group::kFloat, t, t, depth);
                    return of_group(Group::kInteger, t, t, depth);
                case 4: {
                    const Expression a = argument(t), b = argument(t);
                    return make(kSelect, t, {a, b, argument(truth_of(t.width == 1 ? KernelType{Scalar::kInt, 1} : t))});
                }
                case 5: {
                    const KernelType from = with_width(t.width, !is_integer(t.scalar));
                    if (t.scalar == Scalar::kReal) return make(kRealOf, t, {argument({Scalar::kFloat, 1})});
                    if (t.scalar == Scalar::kFloat) return make(kToFloat, t, {argument(from)});
                    if (is_integer(from.scalar) && chance(0.5)) return make(kConvert, t, {argument(from)});
                    return make(kSaturate, t, {argument(from)});
                }
                case 6:  // a truth value
                    if (t.scalar == Scalar::kInt && t.width == 1)
                        return of_group(Group::kCompare, t,
                                        chance(0.2) ? KernelType{Scalar::kReal, 1} : with_width(1, false), depth);
                    if (!is_signed(t.scalar) || t.width == 1) break;
                    return of_group(
                        Group::kCompare, t,
                        {chance(0.3) && t.scalar == Scalar::kInt ? Scalar::kFloat : with_sign(t.scalar, chance(0.5)),
                         t.width},
                        depth);
                case 7: {
                    if (t.scalar == Scalar::kReal) return make(kRealOfIndex, t, {argument({Scalar::kUint, 1})});
                    if (t.scalar == Scalar::kFloat) return make(kFloatOf, t, {argument({Scalar::kInt, t.width})});
                    const bool of_float = bits_of(t.scalar) == 32 && chance(0.3);
                    return make(
                        kBitsOf, t,
                        {argument({of_float ? Scalar::kFloat : with_sign(t.scalar, !is_signed(t.scalar)), t.width})});
                }
                case 8: {
                    if (t.scalar == Scalar::kReal) break;
                    const int width = one_of({2, 3, 4, 8, 16});
                    Expression e = make(kSwizzle, t, {argument({t.scalar, width})});
                    for (int i = 0; i < t.width; ++i)
                        e.order.push_back(static_cast<int>(below(static_cast<std::size_t>(width))));
                    return e;
                }
                case 9: {
                    if (t.width == 1) break;
                    std::vector<Expression> elements;
                    if (chance(0.5)) return make(kSpread, t, {argument({t.scalar, 1})});
                    for (int i = 0; i < t.width; ++i)
                        elements.push_back(expression({t.scalar, 1}, std::min(depth - 1, t.width > 4 ? 0 : 1)));
                    return make(kMake, t, elements);
                }
                case 10: {
                    if (t.width == 1 || t.width == 3) break;
                    const Expression values = argument({t.scalar, one_of({2, 4, 8, 16})});
                    return make(kShuffle, t, {values, argument({with_sign(t.scalar, false), t.width})});
                }
                case 11:
                    if (t.scalar == Scalar::kFloat && t.width == 1)
                        return make(kFloatOfReal, t, {argument({Scalar::kReal, 1})});
                    if (t != KernelType{Scalar::kInt, 1}) break;
                    return make(one_of<std::size_t>({kAll, kAny}), t,
                                {argument({with_sign(with_width(1).scalar, true), one_of({2, 3, 4, 8, 16})})});
                default: {
                    for (std::size_t f = complete_; f-- > 0;) {
                        const KernelFunction& callee = kernel_.functions[f];
                        if (callee.result.type != t || chance(0.3)) continue;
                        std::vector<Expression> arguments;
                        for (std::size_t i = 0; i < callee.parameters; ++i) {
                            const KernelType parameter = kernel_.functions[f].variables[i];
                            arguments.push_back(expression(parameter, std::min(depth - 1, 1)));
                        }
                        return make(kCallFunction, t, arguments, f);
                    }
                    break;
                }
            }
    }

    Statement assignment(std::size_t target, Expression value) {
        return {.kind = Statement::kAssign, .target = target, .values = {std::move(value)}};
    }

    std::vector<Statement> block(std::size_t count, Place place) {
        std::vector<Statement> statements;
        while (statements.size() < count)
            if (std::optional<Statement> s = statement(place)) statements.push_back(std::move(*s));
        return statements;
    }

    std::optional<Statement> statement(Place place) {
        const Place inner{.is_uniform = false, .leaves_loop = place.leaves_loop, .depth = place.depth + 1};
        switch (below(12)) {
            case 0:
                if (place.depth > 1) return {};
                return Statement{.kind = Statement::kIf,
                                 .values = {condition(2)},
                                 .bodies = {block(1 + below(3), inner), block(below(3), inner)}};
            case 1: {
                if (place.depth > 1) return {};
                const std::size_t counter = function().variables.size();
                function().variables.push_back({Scalar::kUint, 1});
                loop_variables_.push_back(counter);
                const bool is_uniform = place.is_uniform && chance(0.5);
                std::vector<Statement> body = block(1 + below(4), {is_uniform, !is_uniform, place.depth + 1});
                return Statement{.kind = Statement::kLoop,
                                 .target = counter,
                                 .count = 1 + static_cast<int>(below(6)),
                                 .bodies = {std::move(body)}};
            }
            case 2: {
                if (place.depth > 1) return {};
                Statement s{.kind = Statement::kSwitch, .values = {expression({Scalar::kUint, 1}, 2)}};
                for (std::size_t n = 2 + below(3); n > 0; --n)
                    s.bodies.push_back(block(1 + below(2), {.depth = place.depth + 1}));
                for (std::size_t i = 0; i + 1 < s.bodies.size(); ++i) s.falls_through.at(i) = chance(0.3);
                return s;
            }
            case 3:
                if (!place.leaves_loop || place.is_uniform) return {};
                return Statement{.kind = chance(0.5) ? Statement::kBreak : Statement::kContinue,
                                 .values = {condition(2)}};
            case 4:
                if (returned_ == nullptr || place.depth == 0) return {};
                return Statement{.kind = Statement::kReturn, .values = {condition(2), expression(*returned_, 2)}};
            case 5:
                if (!is_kernel_) return {};
                return Statement{.kind = Statement::kAtomic,
                                 .target = below(kCounters),
                                 .values = {expression({Scalar::kUint, 1}, 2)}};
            case 6:
            case 7:
                return memory_statement(place);
            default: {
                const std::size_t target = below(function().variables.size());
                if (std::ranges::count(loop_variables_, target) > 0) return {};
                return assignment(target, expression(function().variables[target], 3));
            }
        }
    }

    std::optional<Statement> memory_statement(Place place) {
        if (!is_kernel_ || kernel_.objects.empty()) return {};
        const std::size_t object = below(kernel_.objects.size());
        const MemoryObject& memory = kernel_.objects[object];
        const auto index = [&] { return expression({Scalar::kUint, 1}, 1); };
        const std::vector<std::size_t> targets = variables_of(memory.fields[0], true);
        if (memory.space != MemoryObject::kPrivate && place.is_uniform && !targets.empty())
            return Statement{.kind = Statement::kExchange,
                             .target = one_of(targets),
                             .object = object,
                             .count = static_cast<int>(below(kernel_.group_size)),
                             .values = {expression(memory.fields[0], 2)}};
        if (memory.space == MemoryObject::kPrivate && chance(0.2))
            return Statement{.kind = Statement::kCopy, .object = object, .values = {index(), index()}};
        const std::size_t field = below(memory.fields.size());
        return Statement{.kind = Statement::kStore,
                         .target = field,
                         .object = object,
                         .values = {index(), expression(memory.fields[field], 3)}};
    }

    SplitMix random_;
    RandomKernel kernel_;
    std::size_t complete_ = 0;                 // functions that may be called
    std::vector<std::size_t> loop_variables_;  // of the current function
    const KernelType* returned_ = nullptr;     // type that the current function returns; null in the kernel's body
    bool is_kernel_ = false;
};

}  // namespace

RandomKernel random_kernel(std::uint64_t seed, std::uint64_t number, const std::vector<std::size_t>& changes) {
    RandomKernel kernel = Generator(SplitMix(seed * 0x9e3779b97f4a7c15u + number).next()).kernel();
    for (const std::size_t change : changes) kernel = smaller_kernel(kernel, change).value();
    return kernel;
}

std::vector<std::uint32_t> random_input(std::uint64_t seed, std::uint64_t number) {
    SplitMix random(~(seed * 0x9e3779b97f4a7c15u + number));
    std::vector<std::uint32_t> words(kInputWords);
    for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random.next() >> 32) >> random.next() % 32;
    return words;
}

}  // namespace raya
