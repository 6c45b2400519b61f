// A JSON document as a value: what reports, traces and studies write, and what baselines and checks are read from.
//
// The text is made and read by nlohmann's library, which stays out of this header: to see its templates and to fill a
// document by them costs a file two to three seconds of compilation, and fifty files do.
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

/// A document that lacks a member, or has one of another kind than is asked for. read_json() adds file, line and
/// member.
struct JsonError : UserError {
    explicit JsonError(const std::string& reason, std::uint32_t at = 0) : UserError(reason), position(at) {}
    std::uint32_t position;  // of the value in its text: bytes up to its first token's end; 0: not known
};

class Json;

/// Where a document comes from, for messages; `remedy` may be empty.
struct JsonSource {
    std::string name, remedy{};

    /// UserError "NAME: reason; remedy: REMEDY".
    [[noreturn]] void refuse(const std::string& reason) const;
    /// The same with line and member, of a document that is parsed from `text`.
    [[noreturn]] void refuse(const JsonError& error, const Json& json, const std::string& text) const;
};

/// Null, a truth value, a number, a text, a list or an object, whose members keep the order in which they were added.
class Json {
  public:
    struct Member;

    Json() = default;
    Json(std::initializer_list<Member> members);                           // NOLINT: implicit, as all of these
    Json(std::nullptr_t) {}                                                // NOLINT
    Json(std::string text) : value_(Box<std::string>(std::move(text))) {}  // NOLINT
    Json(std::string_view text) : Json(std::string(text)) {}               // NOLINT
    Json(const char* text) : Json(std::string(text)) {}                    // NOLINT
    template <std::integral T>
    Json(T whole)  // NOLINT
        : value_(static_cast<std::conditional_t<std::is_same_v<T, bool>, bool,
                                                std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>>>(
              whole)) {}
    Json(std::floating_point auto number) : value_(double{number}) {}  // NOLINT
    template <class T>
    Json(const std::optional<T>& value) : Json(value ? Json(*value) : Json()) {}  // NOLINT
    Json(std::vector<Json> list);                                                 // NOLINT
    template <class T>
    Json(const std::vector<T>& list) : Json(std::vector<Json>(list.begin(), list.end())) {}  // NOLINT
    template <class T, std::size_t N>
    Json(const std::array<T, N>& list) : Json(std::vector<Json>(list.begin(), list.end())) {}  // NOLINT

    static Json object();
    static Json list();

    bool is_null() const { return std::holds_alternative<std::monostate>(value_); }
    bool is_text() const { return std::holds_alternative<Box<std::string>>(value_); }

    /// The member of an object, added where it is missing; null becomes an object.
    Json& operator[](std::string_view key);
    Json& operator[](int) = delete;  // 0 would be a null pointer to a name
    /// Appends to a list; null becomes one.
    void push_back(Json element);
    Json& back();

    /// The member of that name; null pointer where there is none, or no object.
    const Json* find(std::string_view key) const;
    /// The same, JsonError where there is none.
    const Json& at(std::string_view key) const;

    /// What the value is; JsonError where it is something else, or for `whole` no whole number from 0 to `most`.
    const std::string& text() const;
    double number() const;
    std::uint64_t whole(std::uint64_t most = UINT64_MAX) const;
    const std::vector<Json>& elements() const;
    /// The names of an object's members, in the order in which they were added; empty for anything else.
    const std::vector<std::string>& keys() const;
    std::vector<std::string> texts() const;

    /// As text, in one line or with so many blanks a level. What is not UTF-8, as a path or a driver's name may be, is
    /// replaced by U+FFFD.
    std::string dump(int indent = -1) const;

    /// Refuses what is not JSON, has a number beyond double precision, a member twice in an object, or over 100 levels.
    static Json parse(const std::string& text, const JsonSource& from);

  private:
    friend class JsonText;
    struct Tree;

    // On the heap, so that a number takes 24 bytes: a document may be one list of millions.
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
    Tree* tree(bool object) const;  // of a list or an object; a null pointer for anything else
    [[noreturn]] void refuse(const std::string& reason) const;

    std::variant<std::monostate, bool, std::uint64_t, std::int64_t, double, Box<std::string>, Box<Tree>> value_;
    std::uint32_t position_ = 0;  // as in JsonError
};

struct Json::Tree {
    std::vector<Json> elements{};
    std::vector<std::string> keys{};  // of an object, one for each element
    bool is_object = false;
};

struct Json::Member {
    std::string key;
    Json value;
};

/// Gives the document to `read`, whose result it returns. Whatever is wrong with the text or, by JsonError or UserError
/// of `read`, with what it says, is a UserError that names the source; the line and the member where they are known.
template <class Read>
auto read_json(const std::string& text, const JsonSource& from, Read&& read) {
    const Json json = Json::parse(text, from);
    try {
        return read(json);
    } catch (const JsonError& error) {
        from.refuse(error, json, text);
    } catch (const UserError& error) {
        from.refuse(error.what());
    }
}

inline constexpr std::uint64_t kLargestJson = 64'000'000;  // bytes of a file

/// The text of a JSON file, for read_json(); UserError as there.
std::string json_text(const std::filesystem::path& file, const JsonSource& from, Pipes pipes = Pipes::kRefused,
                      std::uint64_t most = kLargestJson);

}  // namespace raya
