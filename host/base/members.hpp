// The members of a report's objects. For each type T there is one list of members, the function
//
//     void members_of(Members& m, T& value) {
//         m("pixels", value.pixels, "Number of pixels.");
//         m("ms", "Times of a render.", [&](Members& ms) { ms("best", 1e3 * value.best_s, "Shortest time, ms."); });
//     }
//
// which writes the object, gives its JSON Schema, and reads the object.
#pragma once
#include <algorithm>
#include <concepts>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "host/base/json.hpp"

namespace raya {

/// Copies the members of an object. Json::update() of nlohmann's version 3.11.2 corrupts the paths in messages.
inline void copy_members(const Json& from, Json& to) {
    for (const auto& [name, value] : from.items()) to[name] = value;
}

class Members;

/// True if the members of T are listed, by members_of(Members&, T&) or by members_of(Members&, const T&).
template <class T>
concept HasMembers = requires(Members& members, std::remove_const_t<T>& value) { members_of(members, value); };

/// The JSON object of a T.
template <class T>
struct Written {
    using Object = T;
    Json json = Json::object();
};

/// Visitor of the members of one object. A member is a number, a string, a bool, a type with members, a function that
/// lists the members of an object without a type, a list of members, or a std::optional, which is null if it is empty.
class Members {
  public:
    enum class Mode { kWrite, kDescribe, kRead };

    /// `source`: the object to read.
    explicit Members(Mode mode, const Json* source = nullptr) : mode_(mode), source_(source) {
        if (mode == Mode::kDescribe)
            json_ = {{"type", "object"},
                     {"properties", Json::object()},
                     {"required", Json::array()},
                     {"additionalProperties", false}};
    }

    bool reads() const { return mode_ == Mode::kRead; }

    /// Adds the member `name`. `meaning`: its description in the schema, with unit. Reading stores the value in `value`
    /// if it is a variable, and throws Json::exception if the member is missing or has another type.
    template <class T>
    void operator()(const std::string& name, T&& value, const char* meaning) {
        if (mode_ == Mode::kDescribe) json_["required"].push_back(name);
        add(name, std::forward<T>(value), meaning);
    }

    /// Adds a member that only objects with `present` have; when reading, objects that have the member.
    template <class T>
    void when(bool present, const std::string& name, T&& value, const char* meaning) {
        if (mode_ == Mode::kDescribe || (reads() ? find_member(*source_, name) != nullptr : present))
            add(name, std::forward<T>(value), meaning);
    }

    /// Adds an object whose members `list` lists.
    template <std::invocable<Members&> List>
    void operator()(const std::string& name, const char* meaning, List&& list) {
        (*this)(name, list, meaning);
    }
    template <std::invocable<Members&> List>
    void when(bool present, const std::string& name, const char* meaning, List&& list) {
        when(present, name, list, meaning);
    }

    /// Adds the members of `part`: an object or, if this object describes, a schema.
    void include(const Json& part) {
        if (mode_ == Mode::kWrite) copy_members(part, json_);
        if (mode_ != Mode::kDescribe) return;
        copy_members(part.at("properties"), json_["properties"]);
        for (const Json& name : part.at("required")) json_["required"].push_back(name);
    }

    /// Returns the object, or its schema.
    const Json& json() const { return json_; }

    template <class T>
    static void list(Members& members, T& value) {
        if constexpr (std::invocable<T&, Members&>) {
            value(members);
        } else if constexpr (requires { members_of(members, value); }) {
            members_of(members, value);
        } else {  // a constant, but the function also reads
            std::remove_const_t<T> copy = value;
            members_of(members, copy);
        }
    }

  private:
    template <class T>
    void add(const std::string& name, T&& value, const char* meaning) {
        if (mode_ == Mode::kWrite) json_[name] = written(value);
        if (mode_ == Mode::kRead) read(source_->at(name), std::forward<T>(value));
        if (mode_ != Mode::kDescribe) return;
        json_["properties"][name] = schema(value);
        json_["properties"][name]["description"] = meaning;
    }

    template <class T>
    static constexpr bool is_object = HasMembers<T> || std::invocable<T&, Members&>;
    template <class T>
    static constexpr bool is_text = std::is_convertible_v<T, std::string_view>;

    template <class T>
    static Json written(T& value) {
        if constexpr (is_object<T>) {
            Members members(Mode::kWrite);
            list(members, value);
            return members.json();
        } else if constexpr (requires { value.json; }) {
            return value.json;
        } else if constexpr (requires { value.has_value(); }) {
            return value ? written(*value) : Json();
        } else if constexpr (is_text<T> || std::is_arithmetic_v<std::remove_const_t<T>>) {
            return value;
        } else {
            Json list = Json::array();
            for (const auto& element : value) list.push_back(written(element));
            return list;
        }
    }

    template <class T>
    static Json schema(T& value) {
        using Type = std::remove_const_t<T>;
        if constexpr (is_object<T>) {
            Members members(Mode::kDescribe);
            list(members, value);
            return members.json();
        } else if constexpr (requires { value.json; }) {
            typename Type::Object object{};
            return schema(object);
        } else if constexpr (requires { value.has_value(); }) {
            typename Type::value_type element{};
            Json json = schema(element);
            json["type"] = {json["type"], "null"};
            return json;
        } else if constexpr (std::is_same_v<Type, bool>) {
            return {{"type", "boolean"}};
        } else if constexpr (std::is_unsigned_v<Type>) {
            return {{"type", "integer"}, {"minimum", 0}};
        } else if constexpr (std::is_arithmetic_v<Type>) {
            return {{"type", std::is_integral_v<Type> ? "integer" : "number"}};
        } else if constexpr (is_text<T>) {
            return {{"type", "string"}};
        } else {
            typename Type::value_type element{};
            return {{"type", "array"}, {"items", schema(element)}};
        }
    }

    template <class T>
    static void read(const Json& json, T&& value) {
        using Type = std::remove_reference_t<T>;
        if constexpr (std::invocable<Type&, Members&>) {
            Members members(Mode::kRead, &json);
            value(members);
        } else if constexpr (std::is_const_v<Type> || !std::is_lvalue_reference_v<T> || requires { value.json; }) {
            return;  // a computed value
        } else if constexpr (HasMembers<Type>) {
            Members members(Mode::kRead, &json);
            list(members, value);
        } else if constexpr (requires { value.has_value(); }) {
            return;  // the program reads no optional member
        } else if constexpr (std::is_same_v<Type, bool>) {
            value = json.get<bool>();
        } else if constexpr (std::is_integral_v<Type>) {
            value = static_cast<Type>(json_integer(json, std::numeric_limits<Type>::max()));
        } else if constexpr (std::is_arithmetic_v<Type>) {
            value = json.get<Type>();
        } else if constexpr (is_text<Type>) {
            value = json_text(json);
        } else {
            value.clear();
            for (const Json& element : json_array(json)) read(element, value.emplace_back());
        }
    }

    Mode mode_;
    const Json* source_;
    Json json_ = Json::object();
};

/// Returns the object of a value with members.
template <HasMembers T>
Json to_json(const T& value) {
    Members members(Members::Mode::kWrite);
    Members::list(members, value);
    return members.json();
}

/// Inverse of to_json(). Throws Json::exception.
template <HasMembers T>
T from_json(const Json& json) {
    T value{};
    Members members(Members::Mode::kRead, &json);
    Members::list(members, value);
    return value;
}

/// Returns the JSON Schema of a report. `description`: of the report.
template <HasMembers T>
Json schema_of(const char* title, const char* description, T value = {}) {
    Members members(Members::Mode::kDescribe);
    Members::list(members, value);
    Json json = {
        {"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}, {"description", description}};
    copy_members(members.json(), json);
    return json;
}

/// Returns the schema of objects that are an `a` or a `b`: a member is required if both require it.
inline Json schema_of_either(Json a, const Json& b) {
    if (!find_member(a, "properties")) return a;
    const Json required = std::exchange(a["required"], Json::array());
    for (const Json& name : required)
        if (std::ranges::find(b.at("required"), name) != b.at("required").end()) a["required"].push_back(name);
    for (const auto& [name, member] : b.at("properties").items())
        if (Json& own = a["properties"][name]; own.is_null())
            own = member;
        else
            own = schema_of_either(own, member);
    return a;
}

}  // namespace raya
