// JSON documents as values: the format of raya's reports, traces, studies and messages between its processes.
//
// nlohmann's library writes and parses the text. This header does not include that library, because its templates would
// add two to three seconds of compilation to each of fifty files.
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {

/// Thrown if a member is missing or has another type than requested. read_json() adds the file, the line and the
/// member's path to the message.
struct JsonError : UserError {
    explicit JsonError(const std::string& reason, std::uint32_t at = 0) : UserError(reason), position(at) {}
    std::uint32_t position;  // byte offset, in the text, of the end of the value's first token; 0: unknown
};

class Json;

/// The source of a document (a file or stdin), for messages; `remedy` may be empty.
struct JsonSource {
    std::string name, remedy{};

    /// Throws UserError "NAME: reason; remedy: REMEDY".
    [[noreturn]] void refuse(const std::string& reason) const;
    /// Throws UserError "NAME:LINE: PATH: reason; remedy: REMEDY" with the line and the path of the value at
    /// `error.position`. `json` was parsed from `text`.
    [[noreturn]] void refuse(const JsonError& error, const Json& json, const std::string& text) const;
};

/// A JSON value: null, a Boolean, a number, a string, an array or an object. Members keep the order in which they were
/// added.
class Json {
  public:
    struct Member;

    Json() = default;
    Json(std::initializer_list<Member> members);                           // NOLINT: implicit conversions intended
    Json(std::nullptr_t) {}                                                // NOLINT
    Json(std::string text) : value_(Box<std::string>(std::move(text))) {}  // NOLINT
    Json(std::string_view text) : Json(std::string(text)) {}               // NOLINT
    Json(const char* text) : Json(std::string(text)) {}                    // NOLINT
    template <std::integral T>
    Json(T integer)  // NOLINT
        : value_(static_cast<std::conditional_t<std::is_same_v<T, bool>, bool,
                                                std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>>>(
              integer)) {}
    Json(std::floating_point auto number) : value_(double{number}) {}  // NOLINT
    template <class T>
    Json(const std::optional<T>& value) : Json(value ? Json(*value) : Json()) {}  // NOLINT
    Json(std::vector<Json> list);                                                 // NOLINT
    template <class T>
    Json(const std::vector<T>& list) : Json(std::vector<Json>(list.begin(), list.end())) {}  // NOLINT
    template <class T, std::size_t N>
    Json(const std::array<T, N>& list) : Json(std::vector<Json>(list.begin(), list.end())) {}  // NOLINT

    static Json object();
    static Json array();

    bool is_null() const { return std::holds_alternative<std::monostate>(value_); }
    bool is_text() const { return std::holds_alternative<Box<std::string>>(value_); }

    /// Returns the member `key` of an object, and adds it first if it is missing. A null value becomes an object first.
    /// Throws JsonError for other types.
    Json& operator[](std::string_view key);
    Json& operator[](int) = delete;  // 0 would convert to a null pointer
    /// Appends to an array. A null value becomes an array first. Throws JsonError for other types.
    void push_back(Json element);
    /// Returns the last element of an array, which must not be empty.
    Json& back();

    /// Returns the member `key`; a null pointer if the member is missing or this value is not an object.
    const Json* find(std::string_view key) const;
    /// Returns the member `key`. Throws JsonError if the member is missing.
    const Json& at(std::string_view key) const;

    /// Return the value of a string, a number, an integer in 0..`max`, or the elements of an array. Throw JsonError for
    /// other values.
    const std::string& text() const;
    double number() const;
    std::uint64_t integer(std::uint64_t max = UINT64_MAX) const;
    const std::vector<Json>& elements() const;
    /// Returns the names of an object's members in the order in which they were added; empty for other types.
    const std::vector<std::string>& keys() const;
    /// Returns the elements of an array of strings. Throws JsonError for other values.
    std::vector<std::string> strings() const;

    /// Serialises the value, in one line or with `indent` blanks per level. Bytes that are not UTF-8, as a path or a
    /// driver's name may contain, become U+FFFD.
    std::string dump(int indent = -1) const;

    /// Parses `text`. Throws UserError, as `source` formats it, for invalid JSON, a number outside double precision, a
    /// duplicate member in an object or more than 100 levels of nesting.
    static Json parse(const std::string& text, const JsonSource& source);

  private:
    friend class JsonText;
    struct Tree;

    // Strings, arrays and objects are on the heap, so that a number takes only 24 bytes: a document may contain
    // millions of numbers.
    template <class T>
    class Box {
      public:
        explicit Box(T value) : value_(std::make_unique<T>(std::move(value))) {}
        Box(const Box& other) : Box(*other.value_) {}
        Box(Box&&) noexcept = default;
        Box& operator=(Box other) noexcept { return value_.swap(other.value_), *this; }
        ~Box() = default;
        T& operator*() const { return *value_; }

      private:
        std::unique_ptr<T> value_;
    };

    explicit Json(Tree tree);
    Tree* tree(bool object) const;  // members of an object (true), elements of an array (false); null: other type
    [[noreturn]] void refuse(const std::string& reason) const;

    std::variant<std::monostate, bool, std::uint64_t, std::int64_t, double, Box<std::string>, Box<Tree>> value_;
    std::uint32_t position_ = 0;  // as JsonError::position
};

struct Json::Tree {  // an array or an object
    std::vector<Json> elements{};
    std::vector<std::string> keys{};  // names of an object's elements; empty for an array
    bool is_object = false;
};

struct Json::Member {
    std::string key;
    Json value;
};

/// Parses `text` and returns `read`(document). Parse errors and every JsonError or UserError of `read` become a
/// UserError that names the source and, if known, the line and the member.
template <class Read>
auto read_json(const std::string& text, const JsonSource& source, Read&& read) {
    const Json json = Json::parse(text, source);
    try {
        return read(json);
    } catch (const JsonError& error) {
        source.refuse(error, json, text);
    } catch (const UserError& error) {
        source.refuse(error.what());
    }
}

inline constexpr std::uint64_t kMaxJsonBytes = 64'000'000;  // default maximum size of a JSON file

/// Reads a JSON file into a string for read_json(). Throws UserError, as `source` formats it, if the file cannot be
/// read or has more than `max_bytes` bytes.
std::string json_file_text(const std::filesystem::path& file, const JsonSource& source, Pipes pipes = Pipes::kRefused,
                           std::uint64_t max_bytes = kMaxJsonBytes);

}  // namespace raya
