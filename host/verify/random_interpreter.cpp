// The exact results of a random kernel, and smaller kernels.
#include "host/verify/random_operations.hpp"

namespace raya {
namespace {

using Value = std::array<Bits, 16>;

bool has_exchange(const std::vector<Statement>& statements) {
    return std::ranges::any_of(statements, [](const Statement& s) {
        return s.kind == Statement::kExchange || std::ranges::any_of(s.bodies, has_exchange);
    });
}

enum class Flow { kNext, kBreak, kContinue, kReturn };

struct Frame {
    std::vector<Value> variables;
    Value returned{};
};

/// A work-item: elements[object][element][field].
struct Item {
    std::size_t number = 0;  // its global ID
    Frame frame{};
    std::vector<std::vector<std::vector<Value>>> elements{};
};

class Interpreter {
  public:
    Interpreter(const RandomKernel& kernel, const std::vector<std::uint32_t>& in) : kernel_(kernel), in_(in) {}

    KernelResults run() {
        results_.counters.assign(kCounters, 0);
        for (std::uint32_t group = 0; group < kernel_.groups; ++group) run_group(group);
        return results_;
    }

  private:
    static std::vector<Value> start_values(const std::vector<KernelType>& types) {
        std::vector<Value> values(types.size());
        for (std::size_t i = 0; i < types.size(); ++i) values[i].fill(start_of(types[i].scalar));
        return values;
    }

    void run_group(std::size_t group) {
        const KernelFunction& body = kernel_.functions.back();
        Item item{.frame = {start_values(body.variables)}};
        for (const MemoryObject& object : kernel_.objects)
            item.elements.emplace_back(object.space == MemoryObject::kPrivate ? kPrivateElements : 1,
                                       start_values(object.fields));
        items_.assign(kernel_.group_size, item);
        for (std::size_t i = 0; i < items_.size(); ++i) items_[i].number = group * items_.size() + i;
        run_together(body.body);
        for (const Item& done : items_) append_results(done);
    }

    /// Runs the statements as a group does between its barriers: each statement by all work-items.
    void run_together(const std::vector<Statement>& statements) {
        for (const Statement& s : statements) {
            if (s.kind == Statement::kExchange) {
                for (Item& item : items_) item.elements[s.object][0][0] = value(s.values[0], item.frame, &item);
                for (std::size_t i = 0; i < items_.size(); ++i)
                    items_[i].frame.variables[s.target] =
                        items_[(i + static_cast<std::size_t>(s.count)) % items_.size()].elements[s.object][0][0];
            } else if (s.kind == Statement::kLoop && has_exchange(s.bodies[0])) {
                for (int n = 0; n <= s.count; ++n) {
                    for (Item& item : items_) item.frame.variables[s.target] = {static_cast<Bits>(n)};
                    if (n < s.count) run_together(s.bodies[0]);
                }
            } else {
                for (Item& item : items_) run(s, item.frame, &item);
            }
        }
    }

    Flow run(const std::vector<Statement>& statements, Frame& frame, Item* item) {
        for (const Statement& s : statements)
            if (const Flow flow = run(s, frame, item); flow != Flow::kNext) return flow;
        return Flow::kNext;
    }

    Flow run(const Statement& s, Frame& frame, Item* item) {
        const auto evaluated = [&](std::size_t i) { return value(s.values[i], frame, item); };
        const auto element = [&](std::size_t i) -> std::vector<Value>& {
            auto& elements = item->elements[s.object];
            return elements[evaluated(i)[0] % elements.size()];
        };
        switch (s.kind) {
            case Statement::kAssign:
                frame.variables[s.target] = evaluated(0);
                break;
            case Statement::kStore: {
                const Value stored = evaluated(1);
                element(0)[s.target] = stored;
                break;
            }
            case Statement::kCopy:
                element(0) = std::vector<Value>(element(1));
                break;
            case Statement::kIf:
                return run(s.bodies[evaluated(0)[0] ? 0 : 1], frame, item);
            case Statement::kLoop:
                for (Bits& n = (frame.variables[s.target] = {})[0]; n < static_cast<Bits>(s.count); ++n) {
                    const Flow flow = run(s.bodies[0], frame, item);
                    if (flow == Flow::kBreak) break;
                    if (flow == Flow::kReturn) return flow;
                }
                break;
            case Statement::kSwitch:
                for (std::size_t i = std::min<std::size_t>(evaluated(0)[0] & 3, s.bodies.size() - 1);
                     i < s.bodies.size(); ++i) {
                    if (const Flow flow = run(s.bodies[i], frame, item); flow != Flow::kNext) return flow;
                    if (!s.falls_through[i]) break;
                }
                break;
            case Statement::kBreak:
                return evaluated(0)[0] ? Flow::kBreak : Flow::kNext;
            case Statement::kContinue:
                return evaluated(0)[0] ? Flow::kContinue : Flow::kNext;
            case Statement::kReturn:
                if (evaluated(0)[0] == 0) break;
                frame.returned = evaluated(1);
                return Flow::kReturn;
            case Statement::kAtomic:
                count(s.target, static_cast<std::uint32_t>(evaluated(0)[0]));
                break;
            case Statement::kExchange:
                break;  // see run_together()
        }
        return Flow::kNext;
    }

    void count(std::size_t counter, std::uint32_t x) {
        std::uint32_t& c = results_.counters[counter];
        switch (counter % 6) {
            case 1:
                c -= x;
                break;
            case 2:
                c ^= x;
                break;
            case 3:
                c |= x;
                break;
            case 4:
                c = std::max(c, x);
                break;
            default:
                c += x;
        }
    }

    Value value(const Expression& e, Frame& frame, Item* item) {
        std::array<Value, 3> a{};
        const KernelOperation& operation = kKernelOperations[e.operation];
        if (e.operation == kCallFunction) return called(e, frame, item);
        Value all{};
        for (std::size_t i = 0; i < e.arguments.size(); ++i) {
            const Value argument = value(e.arguments[i], frame, item);
            if (e.operation == kMake)
                all[i] = argument[0];
            else
                a.at(i) = argument;
        }
        const KernelType from = e.arguments.empty() ? e.type : e.arguments[0].type;
        const auto holds = [&](Scalar s, Bits x) { return value_of(s, x) < 0; };  // of an element of a vector
        switch (e.operation) {
            case kConstant:
                return {e.number};
            case kVariable:
                return frame.variables[e.number];
            case kInput:
                return {in_[(a[0][0] + item->number) % kInputWords]};
            case kElement:
                return item->elements[e.object][a[0][0] % item->elements[e.object].size()][e.number];
            case kMake:
                return all;
            case kAll:
            case kAny: {
                const auto count = std::count_if(a[0].begin(), a[0].begin() + from.width,
                                                 [&](Bits x) { return holds(from.scalar, x); });
                return {e.operation == kAll ? count == from.width : count > 0};
            }
            default:
                break;
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(e.type.width); ++i) {
            const Bits x = a[0][i], y = a[1][i], z = a[2][i];
            if (e.operation == kShuffle)
                all[i] = a[0][y % static_cast<Bits>(from.width)];
            else if (e.operation == kSwizzle)
                all[i] = a[0].at(static_cast<std::size_t>(e.order[i]));
            else if (e.operation == kSpread)
                all[i] = a[0][0];
            else if (e.operation == kSelect)
                all[i] = (e.type.width == 1 ? z != 0 : holds(e.arguments[2].type.scalar, z)) ? x : y;
            else
                all[i] = operation.apply({e.type.scalar, from.scalar, x, y, z, kernel_.format});
            if (operation.group == Group::kCompare && e.type.width > 1 && all[i]) all[i] = mask_of(e.type.scalar);
        }
        return all;
    }

    Value called(const Expression& e, Frame& frame, Item* item) {
        const KernelFunction& f = kernel_.functions[e.number];
        Frame inner{start_values(f.variables)};
        for (std::size_t i = 0; i < e.arguments.size(); ++i) inner.variables[i] = value(e.arguments[i], frame, item);
        if (run(f.body, inner, nullptr) == Flow::kReturn) return inner.returned;
        return value(f.result, inner, nullptr);
    }

    /// Calls take(word) for each 32-bit word of a value.
    template <class Take>
    static void for_each_word(KernelType type, const Value& value, const Take& take) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(type.width); ++i) {
            take(static_cast<std::uint32_t>(value[i]));
            if (bits_of(type.scalar) == 64) take(static_cast<std::uint32_t>(value[i] >> 32));
        }
    }

    void append_results(const Item& item) {
        const std::vector<KernelType>& types = kernel_.functions.back().variables;
        for (std::size_t i = 0; i < types.size(); ++i)
            for_each_word(types[i], item.frame.variables[i], [&](std::uint32_t word) { results_.out.push_back(word); });
        for (std::size_t i = 0; i < kernel_.objects.size(); ++i) {
            std::uint32_t sum = 0;
            for (const std::vector<Value>& element : item.elements[i])
                for (std::size_t f = 0; f < element.size(); ++f)
                    for_each_word(kernel_.objects[i].fields[f], element[f],
                                  [&](std::uint32_t word) { sum = sum * 31 + word; });
            results_.out.push_back(sum);
        }
    }

    const RandomKernel& kernel_;
    const std::vector<std::uint32_t>& in_;
    KernelResults results_;
    std::vector<Item> items_;  // of the current group
};

// --- Smaller kernels

/// Visits all lists of statements and all expressions of a kernel, in the same order each time.
struct Visitor {
    std::function<void(std::vector<Statement>&)> list;
    std::function<void(Expression&)> expression;

    void visit(RandomKernel& kernel) const {
        for (auto f = kernel.functions.rbegin(); f != kernel.functions.rend(); ++f) {
            visit(f->body);
            if (f + 1 != kernel.functions.rend() || kernel.functions.size() > 1) visit(f->result);
        }
    }
    void visit(std::vector<Statement>& statements) const {
        list(statements);
        for (Statement& s : statements) {
            for (Expression& value : s.values) visit(value);
            for (std::vector<Statement>& body : s.bodies) visit(body);
        }
    }
    void visit(Expression& e) const {
        expression(e);
        for (Expression& argument : e.arguments) visit(argument);
    }
};

bool leaves_loop(const std::vector<Statement>& statements) {
    return std::ranges::any_of(statements, [](const Statement& s) {
        return s.kind == Statement::kBreak || s.kind == Statement::kContinue ||
               (s.kind != Statement::kLoop && std::ranges::any_of(s.bodies, leaves_loop));
    });
}

/// The simplest expression of a type.
Expression zero_of(KernelType type) {
    const Expression scalar{.operation = kConstant, .type = {type.scalar, 1}, .number = start_of(type.scalar)};
    if (type.width == 1) return scalar;
    return {.operation = kSpread, .type = type, .arguments = {scalar}};
}

}  // namespace

KernelResults interpreted(const RandomKernel& kernel, const std::vector<std::uint32_t>& in) {
    return Interpreter(kernel, in).run();
}

std::size_t size_of(const RandomKernel& kernel) {
    std::size_t size = 0;
    RandomKernel copy = kernel;
    Visitor{[&](const auto& list) { size += list.size(); }, [&](const Expression&) { ++size; }}.visit(copy);
    return size;
}

std::optional<RandomKernel> smaller_kernel(const RandomKernel& kernel, std::size_t change) {
    std::optional<RandomKernel> smaller;
    RandomKernel changed = kernel;
    std::size_t changes = 0;
    // Makes the change of a list or expression, keeps the kernel, and takes the change back.
    const auto offer = [&](auto& part, const auto& value) {
        if (changes++ != change) return;
        auto other = value();
        std::swap(part, other);
        smaller = changed;
        std::swap(part, other);
    };
    using Statements = std::vector<Statement>;
    const auto replaced = [](const Statements& list, std::size_t at, std::size_t count, const Statements& by) {
        Statements all(list.begin(), list.begin() + std::ptrdiff_t(at));
        all.insert(all.end(), by.begin(), by.end());
        all.insert(all.end(), list.begin() + std::ptrdiff_t(std::min(at + count, list.size())), list.end());
        return all;
    };
    Visitor{[&](Statements& list) {
                for (std::size_t size = list.size(); size > 0; size /= 2)
                    for (std::size_t at = 0; at < list.size(); at += size)
                        offer(list, [&] { return replaced(list, at, size, {}); });
                for (std::size_t i = 0; i < list.size(); ++i)
                    for (const Statements& body : list[i].bodies)
                        if (list[i].kind != Statement::kLoop || !leaves_loop(body))
                            offer(list, [&] { return replaced(list, i, 1, body); });
            },
            [](const Expression&) {}}
        .visit(changed);
    Visitor{[](const Statements&) {},
            [&](Expression& e) {
                if (e.operation <= kVariable || (e.operation == kSpread && e.arguments[0].operation == kConstant))
                    return;
                offer(e, [&] { return zero_of(e.type); });
                for (const Expression& argument : e.arguments)
                    if (argument.type == e.type) offer(e, [&] { return Expression(argument); });
            }}
        .visit(changed);
    return smaller;
}

std::vector<std::size_t> reducing_changes(
    RandomKernel kernel, const std::function<bool(const std::vector<std::size_t>&, const RandomKernel&)>& fails) {
    constexpr int kMaxTrials = 1500;
    std::vector<std::size_t> changes;
    int trials = 0;
    for (bool is_smaller = true; is_smaller;) {
        is_smaller = false;
        for (std::size_t change = 0; trials < kMaxTrials; ++trials) {
            std::optional<RandomKernel> smaller = smaller_kernel(kernel, change);
            if (!smaller) break;
            changes.push_back(change);
            if (fails(changes, *smaller)) {  // the next changes are those of the smaller kernel from the same place on
                kernel = std::move(*smaller);
                is_smaller = true;
            } else {
                changes.pop_back();
                ++change;
            }
        }
    }
    return changes;
}

}  // namespace raya
