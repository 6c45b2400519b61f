#include "host/python/convert.hpp"

#include <fmt/core.h>

#include "host/base/encoding.hpp"

namespace raya {
namespace {

// Lists, tuples, numpy arrays.
bool is_sequence(const py::handle& value) {
    return PySequence_Check(value.ptr()) != 0 && !py::isinstance<py::str>(value) && !py::isinstance<py::bytes>(value);
}

std::string text_of(const std::string& option, const py::handle& value) {
    if (py::isinstance<py::bool_>(value))
        throw py::value_error(fmt::format("{}: the option takes a value, not True", option));
    if (!is_sequence(value)) return py::str(value);
    std::string text;
    for (const py::handle element : value) text += (text.empty() ? "" : ",") + text_of(option, element);
    return text;
}

bool holds_sequences(const py::handle& value) {
    if (!is_sequence(value)) return false;
    for (const py::handle element : value)
        if (is_sequence(element) || py::isinstance<py::str>(element)) return true;
    return false;
}

}  // namespace

std::vector<std::string> option_arguments(const py::dict& options) {
    std::vector<std::string> arguments;
    for (const auto& [key, value] : options) {
        std::string name = py::str(key);
        while (name.ends_with('_')) name.pop_back();  // from_ sets --from, because `from` is a Python keyword
        for (char& letter : name)
            if (letter == '_') letter = '-';
        const std::string option = "--" + name;
        if (value.is_none() || value.ptr() == Py_False) continue;
        if (value.ptr() == Py_True)
            arguments.push_back(option);
        else if (name == "light" && holds_sequences(value))
            for (const py::handle light : value) arguments.push_back(option + '=' + text_of(option, light));
        else
            arguments.push_back(option + '=' +
                                (name == "size" ? replaced(text_of(option, value), ",", "x") : text_of(option, value)));
    }
    return arguments;
}

void forbid_new(const py::object& type, const char* remedy) {
    type.attr("__new__") = py::module_::import("builtins")
                               .attr("staticmethod")(py::cpp_function(
                                   [remedy](const py::args&, const py::kwargs&) { throw py::type_error(remedy); }));
}

py::object python_of(const Json& json) { return py::module_::import("json").attr("loads")(json.dump()); }

CostImage cost_image_of(const py::array& cost) {
    const char type_kind = cost.dtype().kind();
    if (cost.ndim() != 2 || (type_kind != 'u' && type_kind != 'i'))
        throw py::value_error("cost: must be an integer array [height, width] of modelled cycles");
    if (type_kind == 'i' && cost.size() > 0 && cost.attr("min")().cast<std::int64_t>() < 0)
        throw py::value_error("cost: modelled cycles must not be negative");
    const CostArray array(cost);
    CostImage image{static_cast<std::uint32_t>(array.shape(1)), static_cast<std::uint32_t>(array.shape(0)), {}};
    image.cycles.assign(array.data(), array.data() + array.size());
    std::uint64_t sum = 0;  // of all PEs
    for (const std::uint64_t cycles : image.cycles)
        if (__builtin_add_overflow(sum, cycles, &sum)) throw py::value_error("cost: the sum is 2^64 or more");
    return image;
}

}  // namespace raya
