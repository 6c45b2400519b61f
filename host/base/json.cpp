#include "host/base/json.hpp"

#include <fmt/core.h>

#include <set>

namespace raya {
namespace {

constexpr auto kReplaceBytes = Json::error_handler_t::replace;

[[noreturn]] void refuse_value(const Json& json, const std::string& reason) {
    constexpr std::size_t kMaxShown = 40;  // characters of the value
    std::string shown = json.is_array()    ? "an array"
                        : json.is_object() ? "an object"
                                           : json.dump(-1, ' ', true, kReplaceBytes);
    if (shown.size() > kMaxShown) shown = shown.substr(0, kMaxShown) + "...";
    throw Json::type_error::create(302, shown + reason, &json);
}

}  // namespace

const Json* find_member(const Json& json, const std::string& key) {
    const auto member = json.find(key);
    return member == json.end() ? nullptr : &*member;
}

const std::string& json_text(const Json& json) {
    if (!json.is_string()) refuse_value(json, " is not a string");
    return json.get_ref<const std::string&>();
}

double json_number(const Json& json) {
    if (!json.is_number()) refuse_value(json, " is not a number");
    return json.get<double>();
}

std::uint64_t json_integer(const Json& json, std::uint64_t max) {
    if (!json.is_number_integer()) refuse_value(json, " is not a whole number");
    if (!json.is_number_unsigned() && json.get<std::int64_t>() < 0) refuse_value(json, " is negative");
    const auto value = json.get<std::uint64_t>();
    if (value > max) refuse_value(json, fmt::format(" is more than {}", max));
    return value;
}

const Json& json_array(const Json& json) {
    if (!json.is_array()) refuse_value(json, " is not an array");
    return json;
}

std::vector<std::string> json_strings(const Json& json) {
    std::vector<std::string> texts;
    for (const Json& element : json_array(json)) texts.push_back(json_text(element));
    return texts;
}

std::string json_dump(const Json& json, int indent) { return json.dump(indent, ' ', false, kReplaceBytes); }

void JsonSource::refuse(const std::string& reason) const {
    throw UserError(fmt::format("{}: {:.400}{}{}", name, reason, remedy.empty() ? "" : "; remedy: ", remedy));
}

std::string json_reason(const Json::exception& error) {
    const std::string text = error.what();  // "[json.exception.type_error.302] REASON"
    return text.substr(text.find("] ") + 2);
}

Json parse_json(const std::string& text, const JsonSource& source) {
    constexpr int kMaxDepth = 100;  // levels of nesting; limits the depth of recursive functions
    std::vector<std::set<std::string>> keys(kMaxDepth + 2);
    const auto check = [&](int depth, Json::parse_event_t event, const Json& parsed) {
        if (depth >= kMaxDepth) source.refuse(fmt::format("nested more than {} levels deep", kMaxDepth));
        const auto level = static_cast<std::size_t>(depth);
        if (event == Json::parse_event_t::object_start) keys[level + 1].clear();
        if (event == Json::parse_event_t::key && !keys[level].insert(json_text(parsed)).second)
            source.refuse(fmt::format("member '{:.40}' occurs twice in a JSON object", json_text(parsed)));
        return true;
    };
    // The library treats a zero byte as the end of the text.
    if (text.find('\0') != std::string::npos) source.refuse("not valid JSON: it contains a zero byte");
    try {
        return Json::parse(text, check);
    } catch (const Json::parse_error& error) {
        source.refuse("not valid JSON: " + json_reason(error));
    } catch (const Json::out_of_range& error) {
        source.refuse("outside the range of double precision: " + json_reason(error));
    }
}

std::string json_file_text(const std::filesystem::path& file, const JsonSource& source, Pipes pipes,
                           std::uint64_t max_bytes) try {
    return read_file(file, pipes, max_bytes);
} catch (const UnreadableFile& error) {
    source.refuse(fmt::format("cannot be read: {}", error.what()));
}

}  // namespace raya
