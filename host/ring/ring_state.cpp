#include "host/ring/ring_state.hpp"

#include <fmt/core.h>

#include <bit>
#include <cstring>
#include <span>

#include "host/base/encoding.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints need a little-endian host");

constexpr std::size_t kHashDigits = 32;

class Writer {
  public:
    explicit Writer(std::string bytes) : bytes_(std::move(bytes)) {}

    template <class T>
    void put(const std::vector<T>& values) {
        const std::uint64_t count = values.size();
        put_raw(&count, sizeof count);
        put_raw(values.data(), count * sizeof(T));
    }
    void put_raw(const void* source, std::size_t bytes) { bytes_.append(static_cast<const char*>(source), bytes); }
    std::string finish() { return bytes_ + bytes_hash(bytes_); }

  private:
    std::string bytes_;
};

class Reader {
  public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}

    template <class T>
    void take(std::vector<T>& values) {
        std::uint64_t count = 0;
        take_raw(&count, sizeof count);
        if (count != values.size()) throw UserError("damaged");
        take_raw(values.data(), count * sizeof(T));
    }
    void take_raw(void* target, std::size_t bytes) {
        if (bytes > bytes_.size()) throw UserError("damaged");
        if (bytes > 0) std::memcpy(target, bytes_.data(), bytes);
        bytes_.remove_prefix(bytes);
    }

  private:
    std::string_view bytes_;
};

// Calls visit(vector) for all vectors of a state, in their order in the file.
template <class State, class Visit>
void for_each_vector(State& state, const Visit& visit) {
    visit(state.image);
    visit(state.pixels);
    visit(state.marks);
    visit(state.all_costs);
    for (auto& pass : state.passes) {
        visit(pass.cycles);
        visit(pass.events);
        visit(pass.costs);
    }
}

Json header_of(const RingState& s, const StateSettings& settings) {
    Json saved_settings = Json::object();
    for (const auto& [name, value] : settings) saved_settings[name] = value;
    return {{"of", saved_settings}, {"pass", s.pass},       {"window", s.window},       {"next", s.next},
            {"share", s.fraction},  {"seconds", s.seconds}, {"passes", s.passes.size()}};
}

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

std::string state_bytes(const RingState& state, const StateSettings& settings) {
    const std::string header = header_of(state, settings).dump();
    Writer writer(fmt::format("{}{}\n", kStateMagic, header));
    writer.put_raw(&state.communication, sizeof state.communication);
    for_each_vector(state, [&](const auto& values) { writer.put(values); });
    return writer.finish();
}

RingState read_state(std::string_view bytes, const StateSettings& settings, RingState state) {
    if (!bytes.starts_with(kStateMagic)) throw UserError("not a checkpoint of this version of raya");
    if (bytes.size() < kStateMagic.size() + kHashDigits ||
        bytes_hash(bytes.substr(0, bytes.size() - kHashDigits)) != bytes.substr(bytes.size() - kHashDigits))
        throw UserError("damaged");
    bytes = bytes.substr(kStateMagic.size(), bytes.size() - kStateMagic.size() - kHashDigits);
    const std::size_t end = bytes.find('\n');
    const Json header = Json::parse(std::string(bytes.substr(0, end)), {"damaged header"});
    check_settings(header.at("of"), settings);
    state.pass = static_cast<std::uint32_t>(header.at("pass").integer(1));
    state.window = static_cast<std::uint32_t>(header.at("window").integer(UINT32_MAX));
    state.next = static_cast<std::uint32_t>(header.at("next").integer(UINT32_MAX));
    state.fraction = header.at("share").number();
    state.seconds = header.at("seconds").number();
    if (header.at("passes").integer() != state.passes.size()) throw UserError("damaged");
    Reader reader(bytes.substr(end + 1));
    reader.take_raw(&state.communication, sizeof state.communication);
    for_each_vector(state, [&](auto& values) { reader.take(values); });
    return state;
}

}  // namespace raya
