// A JSON document as a value: what reports, traces and studies write, and what baselines and checks are read from.
//
// The text is made and read by nlohmann's library, which stays out of this header: to see its templates and to fill a
// document by them costs a file two to three seconds of compilation, and fifty files do.
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace raya {

/// Text that is no JSON.
struct JsonSyntaxError : std::runtime_error {
    explicit JsonSyntaxError(std::size_t at) : runtime_error("no JSON"), byte(at) {}
    std::size_t byte;  // that cannot stand where it does, from 1
};

/// A document that lacks a member, or has one of another kind than is asked for.
struct JsonError : std::runtime_error {
    using runtime_error::runtime_error;
};

/// Null, a truth value, a number, a text, a list or an object, whose members keep the order in which they were added.
class Json {
  public:
    struct Member;

    Json() = default;
    Json(std::initializer_list<Member> members);                            // NOLINT: implicit, as all of these
    Json(std::nullptr_t) {}                                                 // NOLINT
    Json(std::string text) : kind_(Kind::kText), text_(std::move(text)) {}  // NOLINT
    Json(std::string_view text) : Json(std::string(text)) {}                // NOLINT
    Json(const char* text) : Json(std::string(text)) {}                     // NOLINT
    template <std::integral T>
    Json(T whole)  // NOLINT
        : kind_(std::is_same_v<T, bool> ? Kind::kTruth
                : std::is_signed_v<T>   ? Kind::kSigned
                                        : Kind::kUnsigned),
          whole_(static_cast<std::uint64_t>(whole)) {}
    Json(std::floating_point auto number) : kind_(Kind::kFloating), number_(number) {}  // NOLINT
    template <class T>
    Json(const std::optional<T>& value) : Json(value ? Json(*value) : Json()) {}  // NOLINT
    template <class T>
    Json(const std::vector<T>& list) : kind_(Kind::kList), elements_(list.begin(), list.end()) {}  // NOLINT
    template <class T, std::size_t N>
    Json(const std::array<T, N>& list) : kind_(Kind::kList), elements_(list.begin(), list.end()) {}  // NOLINT

    static Json object();
    static Json list();

    bool is_null() const { return kind_ == Kind::kNull; }
    bool is_text() const { return kind_ == Kind::kText; }

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
    const std::vector<std::string>& keys() const { return keys_; }
    std::vector<std::string> texts() const;

    /// As text, in one line or with so many blanks a level. What is not UTF-8, as a path or a driver's name may be, is
    /// replaced by U+FFFD.
    std::string dump(int indent = -1) const;

    /// Throws JsonSyntaxError; JsonError for lists within lists by the hundred.
    static Json parse(const std::string& text);

  private:
    friend struct JsonText;
    enum class Kind { kNull, kTruth, kUnsigned, kSigned, kFloating, kText, kList, kObject };

    explicit Json(Kind kind) : kind_(kind) {}
    void expect(bool is_it, const char* kind) const;

    Kind kind_ = Kind::kNull;
    std::uint64_t whole_ = 0;  // truth, kUnsigned, kSigned (two's complement)
    double number_ = 0;
    std::string text_;
    std::vector<Json> elements_;     // of a list or an object
    std::vector<std::string> keys_;  // of an object, one for each element
};

struct Json::Member {
    std::string key;
    Json value;
};

}  // namespace raya
