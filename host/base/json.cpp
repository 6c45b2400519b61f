#include "host/base/json.hpp"

#include <fmt/core.h>

#include <set>

namespace raya {

const Json* find_member(const Json& json, const std::string& key) {
    const auto member = json.find(key);
    return member == json.end() ? nullptr : &*member;
}

std::uint64_t json_integer(const Json& json, std::uint64_t max) {
    const bool is_valid = json.is_number_unsigned() || (json.is_number_integer() && json.get<std::int64_t>() >= 0);
    if (!is_valid || json.get<std::uint64_t>() > max)
        throw Json::type_error::create(302, fmt::format("must be a whole number from 0 to {}", max), &json);
    return json.get<std::uint64_t>();
}

std::string json_dump(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

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
    } catch (const Json::exception& error) {
        source.refuse("not valid JSON: " + json_reason(error));
    }
}

std::string json_file_text(const std::filesystem::path& file, const JsonSource& source) try {
    return read_file(file, kMaxJsonBytes);
} catch (const UnreadableFile& error) {
    source.refuse(fmt::format("cannot be read: {}", error.what()));
}

}  // namespace raya
