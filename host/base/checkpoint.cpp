#include "host/base/checkpoint.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/base/encoding.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

constexpr std::size_t kHashDigits = 32;

// Throws UserError for the first setting that differs. Hashes are last, so that a named option is reported if possible.
void check_settings(const Json& saved_settings, const StateSettings& settings) {
    for (const auto& [name, value] : settings) {
        const std::string& saved = saved_settings.at(name).text();
        if (saved == value) continue;
        if (name.starts_with("another")) throw UserError("was rendered with " + name);
        if (value == "yes" || value == "no")
            throw UserError(fmt::format("was rendered {} {}", value == "yes" ? "without" : "with", name));
        throw UserError(fmt::format("was rendered with {} {:.80}, not {}", name, saved, value));
    }
}

}  // namespace

CheckpointWriter::CheckpointWriter(const StateSettings& settings, const RenderedPart& part, const Json& integers)
    : bytes_(kStateMagic) {
    Json header = {{"of", Json::object()}, {"fraction", part.fraction}, {"seconds", part.seconds}};
    for (const auto& [name, value] : settings) header["of"][name] = value;
    for (const std::string& name : integers.keys()) header[name] = integers.at(name);
    bytes_ += header.dump() + "\n";
}

void CheckpointWriter::put_numbers(std::span<const std::byte> numbers, std::size_t number_bytes) {
    const std::size_t begin = bytes_.size();
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size());
    convert_little_endian(std::as_writable_bytes(std::span(bytes_).subspan(begin)), number_bytes);
}

std::string CheckpointWriter::finish() {
    bytes_ += bytes_hash(bytes_);
    return std::move(bytes_);
}

CheckpointReader::CheckpointReader(std::string_view bytes, const StateSettings& settings) : bytes_(bytes) {
    if (!bytes.starts_with(kStateMagic)) throw UserError("not a checkpoint of this version of raya");
    if (bytes.size() < kStateMagic.size() + kHashDigits ||
        bytes_hash(bytes.substr(0, bytes.size() - kHashDigits)) != bytes.substr(bytes.size() - kHashDigits))
        throw UserError("damaged");
    bytes_ = bytes.substr(kStateMagic.size(), bytes.size() - kStateMagic.size() - kHashDigits);
    const std::size_t end = bytes_.find('\n');
    header_ = Json::parse(std::string(bytes_.substr(0, end)), {"damaged header"});
    bytes_.remove_prefix(end == std::string_view::npos ? bytes_.size() : end + 1);
    check_settings(header_.at("of"), settings);
}

RenderedPart CheckpointReader::part() const {
    return {header_.at("fraction").number(), header_.at("seconds").number()};
}

std::uint64_t CheckpointReader::integer(const char* name, std::uint64_t max) const {
    return header_.at(name).integer(max);
}

std::uint64_t CheckpointReader::take_count(std::size_t value_bytes, std::optional<std::uint64_t> expected) {
    std::uint64_t count = 0;
    take_numbers(std::as_writable_bytes(std::span(&count, 1)), sizeof count);
    if (count > bytes_.size() / value_bytes || (expected && count != *expected)) throw UserError("damaged");
    return count;
}

void CheckpointReader::take_numbers(std::span<std::byte> numbers, std::size_t number_bytes) {
    if (numbers.size() > bytes_.size()) throw UserError("damaged");
    std::ranges::copy(std::as_bytes(std::span(bytes_.substr(0, numbers.size()))), numbers.begin());
    convert_little_endian(numbers, number_bytes);
    bytes_.remove_prefix(numbers.size());
}

}  // namespace raya
