#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/encoding.hpp"
#include "tests/fuzz/mutate.hpp"

namespace raya::fuzz {
namespace {

using Document = nlohmann::ordered_json;

// Prefix of a string value. text_of() writes the characters after the prefix without quotes, because the JSON library
// cannot write such text.
constexpr const char* kRaw = "\x01raw";

const std::vector<std::string> kRawValues = split(
    "1e400|-1e400|1e308|1e-400|-0|-0.0|18446744073709551615|18446744073709551616|1E5|-9223372036854775808|-"
    "9223372036854775809|99999999999999999999999999|1.5e3|01|1.|nan|Infinity|\"\\ud800\"|\"\\u0000\"|\"\xff\xfe\"|"
    "\"\\x\"|{\"a\":1,\"a\":2}|[1,]|\"open|//|tru",
    '|');

const std::int64_t kIntegers[] = {0,     1,          -1,         2,          3,          4,         7,
                                  8,     16,         255,        256,        1024,       16384,     16385,
                                  65536, 2147483647, 2147483648, 4294967295, 4294967296, INT64_MAX, INT64_MIN};

const std::vector<std::string> kTexts = split(
    "|a|raya render|raya bench|raya verify|raya "
    "tune|cyclic|cyclic:3|column|rows|blocks|grid:2x2|grid:0x4|tiles:2x2|random:7|dynamic:4|hybrid:4,1,0.5|block|fp32|"
    "spa22|e5m10|none|grid|bvh|ring|torus|reduced|<script>|&\"'|\x7f\x1b[31m|\xf0\x9f\x98\x80|iVBORw0KGgo=|"
    "474a384374e81c5144a0e5405232a750",
    '|');

// Reference to a value of a document: the array or object that contains the value, and the value's index or key.
struct ValueReference {
    Document* container;
    std::string key;
    std::size_t index = 0;
};

void add_references(Document& value, std::vector<ValueReference>& references) {
    if (value.is_object())
        for (auto& [key, member] : value.items()) {
            references.push_back({&value, key});
            add_references(member, references);
        }
    if (value.is_array())
        for (std::size_t i = 0; i < value.size(); ++i) {
            references.push_back({&value, {}, i});
            add_references(value[i], references);
        }
}

Document& value_at(const ValueReference& reference) {
    return reference.container->is_object() ? (*reference.container)[reference.key]
                                            : (*reference.container)[reference.index];
}

Document wrapped(Document value, std::size_t levels) {
    for (; levels > 0; --levels) value = Document::array({std::move(value)});
    return value;
}

Document other_value(const Document& value, Random& random) {
    if (random.one_in(6)) return std::string(kRaw) + random.pick(kRawValues);
    if (random.one_in(8)) {
        static const std::size_t kLevels[] = {1, 2, 98, 99, 100, 101, 300};
        return wrapped(value, random.pick(kLevels));
    }
    const bool other_kind = random.one_in(3);  // choose a value of another kind
    if (value.is_number_integer() != other_kind) return random.pick(kIntegers);
    if (value.is_number() != other_kind) return static_cast<double>(random.pick(kIntegers)) / 3;
    if (value.is_string() != other_kind) return random.pick(kTexts);
    static const Document kOtherValues[] = {nullptr, true, false, Document::array(), Document::object(), 1.5};
    return random.pick(kOtherValues);
}

void mutate_text(Document& value, Random& random) {
    std::string text =
        value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, Document::error_handler_t::replace);
    if (random.one_in(4)) text.insert(random.below(text.size() + 1), std::string(1 + random.below(300), 'x'));
    mutate_bytes(text, text.size() + 16);
    value = text;
}

// Repeats a value: inserts up to two copies of an array's element, or one copy of an object's member under another
// name. More copies could make pages of the report too large.
void repeat(const ValueReference& reference, const Document& value, Random& random) {
    if (reference.container->is_array())
        for (std::size_t n = random.below(3); n > 0; --n)
            reference.container->insert(reference.container->begin() + static_cast<std::ptrdiff_t>(reference.index),
                                        value);
    else
        (*reference.container)[reference.key + "2"] = value;
}

void damage(Document& document, Random& random) {
    std::vector<ValueReference> references;
    add_references(document, references);
    if (references.empty()) {
        document = other_value(document, random);
        return;
    }
    const ValueReference reference = random.pick(references);
    Document& value = value_at(reference);
    switch (random.below(7)) {
        case 0:
            reference.container->is_object() ? static_cast<void>(reference.container->erase(reference.key))
                                             : reference.container->erase(reference.index);
            break;
        case 1:
            repeat(reference, Document(value), random);
            break;
        case 2:
            value = Document(value_at(random.pick(references)));
            break;
        case 3:
            mutate_text(value, random);
            break;
        default:
            value = other_value(value, random);
    }
}

std::string text_of(const Document& document, Random& random) {
    std::string text = document.dump(random.one_in(3) ? -1 : 1, ' ', false, Document::error_handler_t::replace);
    const std::string raw_prefix = "\"\\u0001raw";
    for (std::size_t at; (at = text.find(raw_prefix)) != std::string::npos;) {
        std::size_t end = at + raw_prefix.size();
        std::string raw;
        for (; end < text.size() && text[end] != '"'; ++end) raw += text[end] == '\\' ? text[++end] : text[end];
        text.replace(at, end + 1 - at, raw);
    }
    return text;
}

}  // namespace

bool damage_json(std::string& text, Random& random) {
    Document document = Document::parse(text, nullptr, false);
    if (document.is_discarded()) return false;
    for (std::size_t changes = 1 + random.below(2); changes > 0; --changes) damage(document, random);
    text = text_of(document, random);
    return true;
}

}  // namespace raya::fuzz
