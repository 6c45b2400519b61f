#include "host/base/json.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <istream>
#include <nlohmann/json.hpp>

namespace raya {

using Library = nlohmann::ordered_json;

// SAX handler that builds a Json document while nlohmann's parser reads, so that only one document is in memory. It is
// also the stream buffer from which the parser reads the text: the library does not report the positions of values, but
// the buffer's read position gives them.
class JsonText : public std::streambuf {
  public:
    JsonText(const std::string& text, Json& root) : root_(root) {
        char* const begin = const_cast<char*>(text.data());  // setg() takes a mutable buffer; nothing writes to it
        setg(begin, begin, begin + text.size());
        // The library treats a zero byte as the end of the text.
        if (const auto zero = text.find('\0'); zero != text.npos) refuse_byte(zero + 1);
        std::istream stream(this);
        Library::sax_parse(stream, this);
    }

    bool null() { return place({}); }
    bool boolean(bool truth) { return place(truth); }
    bool number_integer(std::int64_t whole) { return place(whole); }
    bool number_unsigned(std::uint64_t whole) { return place(whole); }
    bool number_float(double number, const std::string&) { return place(number); }
    bool string(std::string& text) { return place(std::move(text)); }
    bool binary(const Library::binary_t&) { return false; }
    bool start_array(std::size_t) { return open(Json::array()); }
    bool start_object(std::size_t) { return open(Json::object()); }
    bool end_array() { return close(); }
    bool end_object() { return close(); }
    bool key(std::string& name) {
        open_.back()->keys.push_back(std::move(name));
        return true;
    }
    bool parse_error(std::size_t byte, const std::string& token, const Library::exception& error) {
        if (dynamic_cast<const Library::out_of_range*>(&error) == nullptr) refuse_byte(byte);
        place({});
        throw JsonError(fmt::format("{:.40} is outside the range of double precision", token), position());
    }

    static Library library_of(const Json& json);
    static std::string path_of(const Json* json, std::uint32_t position);

  private:
    static constexpr std::size_t kMaxDepth = 100;  // levels; bounds the stack of functions that recurse into a document

    std::uint32_t position() const { return static_cast<std::uint32_t>(gptr() - eback()); }
    [[noreturn]] static void refuse_byte(std::size_t byte) {
        throw JsonError(fmt::format("not valid JSON (byte {})", byte), static_cast<std::uint32_t>(byte));
    }
    Json& added(Json value) {
        value.position_ = position();
        if (open_.empty()) return root_ = std::move(value);
        return open_.back()->elements.emplace_back(std::move(value));
    }
    bool place(Json value) {
        added(std::move(value));
        return true;
    }
    bool open(Json value) {
        if (open_.size() == kMaxDepth)
            throw JsonError(fmt::format("nested more than {} levels deep", kMaxDepth), position());
        open_.push_back(&*std::get<Json::Box<Json::Tree>>(added(std::move(value)).value_));
        return true;
    }
    bool close() {
        std::vector<std::pair<std::string_view, std::uint32_t>> keys;
        for (std::size_t i = 0; i < open_.back()->keys.size(); ++i)
            keys.emplace_back(open_.back()->keys[i], open_.back()->elements[i].position_);
        std::ranges::sort(keys);
        const auto twice = std::ranges::adjacent_find(keys, {}, &std::pair<std::string_view, std::uint32_t>::first);
        if (twice != keys.end()) throw JsonError("the object has this member twice", std::next(twice)->second);
        open_.pop_back();
        return true;
    }

    Json& root_;
    std::vector<Json::Tree*> open_;
};

Library JsonText::library_of(const Json& json) {
    const auto each = [](const auto& value) -> Library {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::monostate>) return nullptr;
        if constexpr (std::is_same_v<Value, Json::Box<std::string>>) return *value;
        if constexpr (std::is_arithmetic_v<Value>) return value;
        if constexpr (std::is_same_v<Value, Json::Box<Json::Tree>>) {
            const Json::Tree& tree = *value;
            Library all = tree.is_object ? Library::object() : Library::array();
            for (std::size_t i = 0; i < tree.elements.size(); ++i) {
                if (tree.is_object)
                    all[tree.keys[i]] = library_of(tree.elements[i]);
                else
                    all.push_back(library_of(tree.elements[i]));
            }
            return all;
        }
    };
    return std::visit(each, json.value_);
}

// Returns the path of the value at that position, such as "rows[3].ms: "; empty if there is none. Relies on
// the positions of values ascending in the order of the text.
std::string JsonText::path_of(const Json* json, std::uint32_t position) {
    std::string path;
    while (json->position_ != position) {
        const auto* const box = std::get_if<Json::Box<Json::Tree>>(&json->value_);
        if (box == nullptr || (**box).elements.empty() || (**box).elements[0].position_ > position) return {};
        const auto next = std::ranges::upper_bound((**box).elements, position, {}, &Json::position_) - 1;
        const auto i = static_cast<std::size_t>(next - (**box).elements.begin());
        path += (**box).is_object ? fmt::format("{}{:.40}", path.empty() ? "" : ".", (**box).keys[i])
                                  : fmt::format("[{}]", i);
        json = &*next;
    }
    return path.empty() ? path : path + ": ";
}

void JsonSource::refuse(const std::string& reason) const {
    throw UserError(fmt::format("{}: {:.400}{}{}", name, reason, remedy.empty() ? "" : "; remedy: ", remedy));
}

void JsonSource::refuse(const JsonError& error, const Json& json, const std::string& text) const {
    if (error.position == 0) refuse(std::string(error.what()));
    const auto before = std::string_view(text).substr(0, error.position - 1);
    JsonSource{fmt::format("{}:{}", name, 1 + std::ranges::count(before, '\n')), remedy}.refuse(
        JsonText::path_of(&json, error.position) + error.what());
}

Json::Json(Tree tree) : value_(Box(std::move(tree))) {}

Json::Json(std::vector<Json> list) : Json(Tree{.elements = std::move(list)}) {}

Json::Json(std::initializer_list<Member> members) : Json(object()) {
    for (const Member& member : members) (*this)[member.key] = member.value;
}

Json Json::object() { return Json(Tree{.is_object = true}); }

Json Json::array() { return Json(Tree{}); }

Json::Tree* Json::tree(bool object) const {
    const auto* const box = std::get_if<Box<Tree>>(&value_);
    return box != nullptr && (**box).is_object == object ? &**box : nullptr;
}

void Json::refuse(const std::string& reason) const {
    constexpr std::size_t kShown = 40;
    const auto replace = Library::error_handler_t::replace;
    std::string shown = tree(false)  ? "an array"
                        : tree(true) ? "an object"
                                     : JsonText::library_of(*this).dump(-1, ' ', true, replace);
    if (shown.size() > kShown) shown = shown.substr(0, kShown) + "...";
    throw JsonError(shown + reason, position_);
}

Json& Json::operator[](std::string_view key) {
    if (is_null()) *this = object();
    Tree* const all = tree(true);
    if (all == nullptr) refuse(" is not an object");
    const auto at = static_cast<std::size_t>(std::ranges::find(all->keys, key) - all->keys.begin());
    if (at == all->keys.size()) {
        all->keys.emplace_back(key);
        all->elements.emplace_back();
    }
    return all->elements[at];
}

void Json::push_back(Json element) {
    if (is_null()) *this = array();
    if (!tree(false)) refuse(" is not an array");
    tree(false)->elements.push_back(std::move(element));
}

Json& Json::back() { return tree(false)->elements.back(); }

const Json* Json::find(std::string_view key) const {
    const auto at = static_cast<std::size_t>(std::ranges::find(keys(), key) - keys().begin());
    return at == keys().size() ? nullptr : &tree(true)->elements[at];
}

const Json& Json::at(std::string_view key) const {
    if (const Json* member = find(key)) return *member;
    throw JsonError(fmt::format("'{}' is missing", key), position_);
}

const std::vector<std::string>& Json::keys() const {
    static const std::vector<std::string> none;
    return tree(true) ? tree(true)->keys : none;
}

const std::string& Json::text() const {
    if (!is_text()) refuse(" is not a string");
    return *std::get<Box<std::string>>(value_);
}

double Json::number() const {
    if (const auto* whole = std::get_if<std::uint64_t>(&value_)) return static_cast<double>(*whole);
    if (const auto* whole = std::get_if<std::int64_t>(&value_)) return static_cast<double>(*whole);
    if (const auto* number = std::get_if<double>(&value_)) return *number;
    refuse(" is not a number");
}

std::uint64_t Json::integer(std::uint64_t max) const {
    const auto* const given = std::get_if<std::int64_t>(&value_);
    if (given != nullptr && *given < 0) refuse(" is negative");
    const auto* const whole = std::get_if<std::uint64_t>(&value_);
    if (given == nullptr && whole == nullptr) refuse(" is not a whole number");
    const std::uint64_t value = whole != nullptr ? *whole : static_cast<std::uint64_t>(*given);
    if (value > max) refuse(fmt::format(" is more than {}", max));
    return value;
}

const std::vector<Json>& Json::elements() const {
    if (!tree(false)) refuse(" is not an array");
    return tree(false)->elements;
}

std::vector<std::string> Json::strings() const {
    std::vector<std::string> all;
    for (const Json& element : elements()) all.push_back(element.text());
    return all;
}

std::string Json::dump(int indent) const {
    return JsonText::library_of(*this).dump(indent, ' ', false, Library::error_handler_t::replace);
}

Json Json::parse(const std::string& text, const JsonSource& from) {
    Json json;
    try {
        JsonText(text, json);
    } catch (const JsonError& error) {
        from.refuse(error, json, text);
    }
    return json;
}

std::string json_text(const std::filesystem::path& file, const JsonSource& from, Pipes pipes,
                      std::uint64_t max_bytes) try {
    return read_file(file, pipes, max_bytes);
} catch (const UnreadableFile& error) {
    from.refuse(fmt::format("cannot be read: {}", error.what()));
}

}  // namespace raya
