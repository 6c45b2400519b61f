#include "host/base/json.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <istream>
#include <nlohmann/json.hpp>

namespace raya {

using NlohmannJson = nlohmann::ordered_json;

// SAX handler that builds a Json document while nlohmann's parser reads, so that only one document is in memory. It is
// also the stream buffer from which the parser reads the text: the library does not report the positions of values, but
// the buffer's read position gives them.
class JsonText : public std::streambuf {
  public:
    JsonText(const std::string& text, Json& document) : document_(document) {
        char* const begin = const_cast<char*>(text.data());  // setg() takes a mutable buffer; nothing writes to it
        setg(begin, begin, begin + text.size());
        // The library treats a zero byte as the end of the text.
        if (const auto zero = text.find('\0'); zero != text.npos) refuse_byte(zero + 1);
        std::istream stream(this);
        NlohmannJson::sax_parse(stream, this);
    }

    bool null() { return add_value({}); }
    bool boolean(bool truth) { return add_value(truth); }
    bool number_integer(std::int64_t whole) { return add_value(whole); }
    bool number_unsigned(std::uint64_t whole) { return add_value(whole); }
    bool number_float(double number, const std::string&) { return add_value(number); }
    bool string(std::string& text) { return add_value(std::move(text)); }
    bool binary(const NlohmannJson::binary_t&) { return false; }
    bool start_array(std::size_t) { return open_tree(Json::array()); }
    bool start_object(std::size_t) { return open_tree(Json::object()); }
    bool end_array() { return close_tree(); }
    bool end_object() { return close_tree(); }
    bool key(std::string& name) {
        open_trees_.back()->keys.push_back(std::move(name));
        return true;
    }
    bool parse_error(std::size_t byte, const std::string& token, const NlohmannJson::exception& error) {
        if (dynamic_cast<const NlohmannJson::out_of_range*>(&error) == nullptr) refuse_byte(byte);
        add_value({});  // a value at this position, for path_of()
        throw JsonError(fmt::format("{:.40} is outside the range of double precision", token), position());
    }

    static NlohmannJson nlohmann_json_of(const Json& json);
    static std::string path_of(const Json* json, std::uint32_t position);

  private:
    static constexpr std::size_t kMaxDepth = 100;  // levels of nesting; limits the depth of recursive functions

    std::uint32_t position() const { return static_cast<std::uint32_t>(gptr() - eback()); }
    [[noreturn]] static void refuse_byte(std::size_t byte) {
        throw JsonError(fmt::format("not valid JSON (byte {})", byte), static_cast<std::uint32_t>(byte));
    }
    Json& append(Json value) {
        value.position_ = position();
        if (open_trees_.empty()) return document_ = std::move(value);
        return open_trees_.back()->elements.emplace_back(std::move(value));
    }
    bool add_value(Json value) {
        append(std::move(value));
        return true;
    }
    bool open_tree(Json value) {
        if (open_trees_.size() == kMaxDepth)
            throw JsonError(fmt::format("nested more than {} levels deep", kMaxDepth), position());
        open_trees_.push_back(&*std::get<Json::Box<Json::Tree>>(append(std::move(value)).value_));
        return true;
    }
    bool close_tree() {
        std::vector<std::pair<std::string_view, std::uint32_t>> keys;
        for (std::size_t i = 0; i < open_trees_.back()->keys.size(); ++i)
            keys.emplace_back(open_trees_.back()->keys[i], open_trees_.back()->elements[i].position_);
        std::ranges::sort(keys);
        const auto duplicate = std::ranges::adjacent_find(keys, {}, &std::pair<std::string_view, std::uint32_t>::first);
        if (duplicate != keys.end())
            throw JsonError(fmt::format("member '{:.40}' occurs twice in this JSON object", duplicate->first),
                            std::next(duplicate)->second);
        open_trees_.pop_back();
        return true;
    }

    Json& document_;
    std::vector<Json::Tree*> open_trees_;
};

NlohmannJson JsonText::nlohmann_json_of(const Json& json) {
    const auto to_nlohmann = [](const auto& value) -> NlohmannJson {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::monostate>) return nullptr;
        if constexpr (std::is_same_v<Value, Json::Box<std::string>>) return *value;
        if constexpr (std::is_arithmetic_v<Value>) return value;
        if constexpr (std::is_same_v<Value, Json::Box<Json::Tree>>) {
            const Json::Tree& tree = *value;
            NlohmannJson result = tree.is_object ? NlohmannJson::object() : NlohmannJson::array();
            for (std::size_t i = 0; i < tree.elements.size(); ++i) {
                if (tree.is_object)
                    result[tree.keys[i]] = nlohmann_json_of(tree.elements[i]);
                else
                    result.push_back(nlohmann_json_of(tree.elements[i]));
            }
            return result;
        }
    };
    return std::visit(to_nlohmann, json.value_);
}

// Returns the path of the value at `position`, such as "rows[3].ms: "; empty if no value is there. Relies on
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
    constexpr std::size_t kMaxShown = 40;  // characters of the value
    const auto replace = NlohmannJson::error_handler_t::replace;
    std::string shown = tree(false)  ? "an array"
                        : tree(true) ? "an object"
                                     : JsonText::nlohmann_json_of(*this).dump(-1, ' ', true, replace);
    if (shown.size() > kMaxShown) shown = shown.substr(0, kMaxShown) + "...";
    throw JsonError(shown + reason, position_);
}

Json& Json::operator[](std::string_view key) {
    if (is_null()) *this = object();
    Tree* const members = tree(true);
    if (members == nullptr) refuse(" is not a JSON object");
    const auto at = static_cast<std::size_t>(std::ranges::find(members->keys, key) - members->keys.begin());
    if (at == members->keys.size()) {
        members->keys.emplace_back(key);
        members->elements.emplace_back();
    }
    return members->elements[at];
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
    static const std::vector<std::string> no_keys;
    return tree(true) ? tree(true)->keys : no_keys;
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
    const auto* const signed_value = std::get_if<std::int64_t>(&value_);
    if (signed_value != nullptr && *signed_value < 0) refuse(" is negative");
    const auto* const unsigned_value = std::get_if<std::uint64_t>(&value_);
    if (signed_value == nullptr && unsigned_value == nullptr) refuse(" is not a whole number");
    const std::uint64_t value = unsigned_value != nullptr ? *unsigned_value : static_cast<std::uint64_t>(*signed_value);
    if (value > max) refuse(fmt::format(" is more than {}", max));
    return value;
}

const std::vector<Json>& Json::elements() const {
    if (!tree(false)) refuse(" is not an array");
    return tree(false)->elements;
}

std::vector<std::string> Json::strings() const {
    std::vector<std::string> texts;
    for (const Json& element : elements()) texts.push_back(element.text());
    return texts;
}

std::string Json::dump(int indent) const {
    return JsonText::nlohmann_json_of(*this).dump(indent, ' ', false, NlohmannJson::error_handler_t::replace);
}

Json Json::parse(const std::string& text, const JsonSource& source) {
    Json json;
    try {
        JsonText(text, json);
    } catch (const JsonError& error) {
        source.refuse(error, json, text);
    }
    return json;
}

std::string json_file_text(const std::filesystem::path& file, const JsonSource& source, Pipes pipes,
                           std::uint64_t max_bytes) try {
    return read_file(file, pipes, max_bytes);
} catch (const UnreadableFile& error) {
    source.refuse(fmt::format("cannot be read: {}", error.what()));
}

}  // namespace raya
