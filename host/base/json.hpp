// JSON documents: the format of raya's reports, traces, studies and messages between its processes. Values are read and
// written with nlohmann's library; its exceptions become UserError in read_json().
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/base/whole_file.hpp"
#include "host/error.hpp"

template <class T>
struct nlohmann::adl_serializer<std::optional<T>> {
    template <class J>
    static void to_json(J& json, const std::optional<T>& value) {
        json = value ? J(*value) : J();
    }
};

namespace raya {

/// A JSON value. Members keep the order in which they were added. Its exceptions contain the path of the value, because
/// JSON_DIAGNOSTICS is defined. `json[key] = ...` on a null value crashes if memory is short: start with
/// Json::object().
using Json = nlohmann::ordered_json;

/// Returns the member `key`; a null pointer if the member is missing or `json` is not an object.
const Json* find_member(const Json& json, const std::string& key);

/// Return a string, the strings of an array, an array, or an integer in 0..`max`. Throw Json::exception with the path
/// of the value for other values.
inline std::string json_text(const Json& json) { return json.get<std::string>(); }
inline std::vector<std::string> json_strings(const Json& json) { return json.get<std::vector<std::string>>(); }
inline const Json::array_t& json_array(const Json& json) { return json.get_ref<const Json::array_t&>(); }
std::uint64_t json_integer(const Json& json, std::uint64_t max = UINT64_MAX);

/// Serialises the value, in one line or with `indent` blanks per level. Bytes that are not UTF-8, as a path or a
/// driver's name may contain, become U+FFFD.
std::string json_dump(const Json& json, int indent = -1);

/// The source of a document (a file or stdin), for messages; `remedy` may be empty.
struct JsonSource {
    std::string name, remedy{};

    /// Throws UserError "NAME: reason; remedy: REMEDY".
    [[noreturn]] void refuse(const std::string& reason) const;
};

/// Parses `text`. Throws UserError, as `source` formats it, for invalid JSON, a number outside double precision, a
/// duplicate member in an object or more than 100 levels of nesting.
Json parse_json(const std::string& text, const JsonSource& source);

/// Returns the message of an exception of the library: "(/rows/3/ms) type must be number, but is string".
std::string json_reason(const Json::exception& error);

/// Parses `text` and returns `read`(document). Parse errors and every Json::exception or UserError of `read` become a
/// UserError that names the source, the line of a parse error, and the member.
template <class Read>
auto read_json(const std::string& text, const JsonSource& source, Read&& read) {
    const Json json = parse_json(text, source);
    try {
        return read(json);
    } catch (const Json::exception& error) {
        source.refuse(json_reason(error));
    } catch (const UserError& error) {
        source.refuse(error.what());
    }
}

inline constexpr std::uint64_t kMaxJsonBytes = 64'000'000;  // maximum size of a JSON file

/// Reads a JSON file into a string for read_json(). Throws UserError, as `source` formats it, if the file cannot be
/// read or has more than kMaxJsonBytes bytes.
std::string json_file_text(const std::filesystem::path& file, const JsonSource& source);

}  // namespace raya
