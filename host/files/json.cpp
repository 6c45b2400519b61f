#include "host/files/json.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace raya {

// To and from the library's documents.
struct JsonText {
    using Library = nlohmann::ordered_json;
    using Kind = Json::Kind;
    static constexpr int kMostLevels = 100;  // what is read by recursion must not be as deep as a stranger likes

    static Library library_of(const Json& json) {
        Library all;
        switch (json.kind_) {
            case Kind::kNull:
                return nullptr;
            case Kind::kTruth:
                return json.whole_ != 0;
            case Kind::kUnsigned:
                return json.whole_;
            case Kind::kSigned:
                return static_cast<std::int64_t>(json.whole_);
            case Kind::kFloating:
                return json.number_;
            case Kind::kText:
                return json.text_;
            case Kind::kList:
                all = Library::array();
                for (const Json& element : json.elements_) all.push_back(library_of(element));
                return all;
            case Kind::kObject:
                all = Library::object();
                for (std::size_t i = 0; i < json.keys_.size(); ++i) all[json.keys_[i]] = library_of(json.elements_[i]);
                return all;
        }
        return all;
    }

    static Json json_of(const Library& value, int levels = kMostLevels) {
        if (levels == 0) throw JsonError("it is nested too deeply");
        Json all;
        switch (value.type()) {
            case Library::value_t::boolean:
                return value.get<bool>();
            case Library::value_t::number_integer:
                return value.get<std::int64_t>();
            case Library::value_t::number_unsigned:
                return value.get<std::uint64_t>();
            case Library::value_t::number_float:
                return value.get<double>();
            case Library::value_t::string:
                return value.get<std::string>();
            case Library::value_t::array:
                all = Json::list();
                for (const Library& element : value) all.push_back(json_of(element, levels - 1));
                return all;
            case Library::value_t::object:
                all = Json::object();
                for (const auto& [key, member] : value.items()) all[key] = json_of(member, levels - 1);
                return all;
            default:
                return all;
        }
    }
};

Json::Json(std::initializer_list<Member> members) : kind_(Kind::kObject) {
    for (const Member& member : members) (*this)[member.key] = member.value;
}

Json Json::object() { return Json(Kind::kObject); }

Json Json::list() { return Json(Kind::kList); }

void Json::expect(bool is_it, const char* kind) const {
    if (!is_it) throw JsonError(fmt::format("{} is no {}", dump(), kind));
}

Json& Json::operator[](std::string_view key) {
    if (is_null()) kind_ = Kind::kObject;
    expect(kind_ == Kind::kObject, "object");
    const auto at = std::ranges::find(keys_, key) - keys_.begin();
    if (static_cast<std::size_t>(at) == keys_.size()) {
        keys_.emplace_back(key);
        elements_.emplace_back();
    }
    return elements_[static_cast<std::size_t>(at)];
}

void Json::push_back(Json element) {
    if (is_null()) kind_ = Kind::kList;
    expect(kind_ == Kind::kList, "list");
    elements_.push_back(std::move(element));
}

Json& Json::back() { return elements_.back(); }

const Json* Json::find(std::string_view key) const {
    const auto at = static_cast<std::size_t>(std::ranges::find(keys_, key) - keys_.begin());
    return at == keys_.size() ? nullptr : &elements_[at];
}

const Json& Json::at(std::string_view key) const {
    if (const Json* member = find(key)) return *member;
    throw JsonError(fmt::format("'{}' is missing", key));
}

const std::string& Json::text() const {
    expect(kind_ == Kind::kText, "text");
    return text_;
}

double Json::number() const {
    if (kind_ == Kind::kUnsigned) return static_cast<double>(whole_);
    if (kind_ == Kind::kSigned) return static_cast<double>(static_cast<std::int64_t>(whole_));
    expect(kind_ == Kind::kFloating, "number");
    return number_;
}

std::uint64_t Json::whole(std::uint64_t most) const {
    expect(kind_ == Kind::kUnsigned || kind_ == Kind::kSigned, "whole number");
    expect(kind_ == Kind::kUnsigned || static_cast<std::int64_t>(whole_) >= 0, "number from 0 on");
    if (whole_ > most) throw JsonError(fmt::format("{} is more than {}", whole_, most));
    return whole_;
}

const std::vector<Json>& Json::elements() const {
    expect(kind_ == Kind::kList, "list");
    return elements_;
}

std::vector<std::string> Json::texts() const {
    std::vector<std::string> all;
    for (const Json& element : elements()) all.push_back(element.text());
    return all;
}

std::string Json::dump(int indent) const {
    return JsonText::library_of(*this).dump(indent, ' ', false, JsonText::Library::error_handler_t::replace);
}

Json Json::parse(const std::string& text) {
    try {
        return JsonText::json_of(JsonText::Library::parse(text));
    } catch (const JsonText::Library::parse_error& error) {
        throw JsonSyntaxError(error.byte);
    }
}

}  // namespace raya
