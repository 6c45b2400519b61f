#include "host/base/json.hpp"

#include <fmt/core.h>

namespace raya {
namespace {

std::string reason(const Json::exception& error) {
    const std::string text = error.what();  // "[json.exception.type_error.302] REASON"
    return text.substr(text.find("] ") + 2);
}

}  // namespace

std::string json_dump(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

void JsonSource::refuse(const std::string& reason) const {
    throw UserError(fmt::format("{}: {:.400}{}{}", name, reason, remedy.empty() ? "" : "; remedy: ", remedy));
}

void JsonSource::refuse(const Json::exception& error) const { refuse(reason(error)); }

Json parse_json(const std::string& text, const JsonSource& source) {
    constexpr int kMaxDepth = 100;  // levels of nesting; limits the depth of recursive functions
    const auto check_depth = [&](int depth, Json::parse_event_t, const Json&) {
        if (depth >= kMaxDepth) source.refuse(fmt::format("nested more than {} levels deep", kMaxDepth));
        return true;
    };
    // The library treats a zero byte as the end of the text.
    if (text.find('\0') != std::string::npos) source.refuse("not valid JSON: it contains a zero byte");
    try {
        return Json::parse(text, check_depth);
    } catch (const Json::exception& error) {
        source.refuse("not valid JSON: " + reason(error));
    }
}

std::string json_file_text(const std::filesystem::path& file, const JsonSource& source) try {
    return read_file(file, kMaxJsonBytes);
} catch (const UnreadableFile& error) {
    source.refuse(fmt::format("cannot be read: {}", error.what()));
}

}  // namespace raya
