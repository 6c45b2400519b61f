#include "host/ring/ring_state.hpp"

#include "host/error.hpp"

namespace raya {
namespace {

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

}  // namespace

std::string state_bytes(const RingState& s, const StateSettings& settings) {
    CheckpointWriter writer(settings, s.part,
                            {{"pass", s.pass}, {"window", s.window}, {"next", s.next}, {"passes", s.passes.size()}});
    writer.put(std::vector{s.communication});
    for_each_vector(s, [&](const auto& values) { writer.put(values); });
    return writer.finish();
}

RingState read_state(std::string_view bytes, const StateSettings& settings, RingState state) {
    CheckpointReader reader(bytes, settings);
    state.part = reader.part();
    state.pass = static_cast<std::uint32_t>(reader.integer("pass", 1));
    state.window = static_cast<std::uint32_t>(reader.integer("window", UINT32_MAX));
    state.next = static_cast<std::uint32_t>(reader.integer("next", UINT32_MAX));
    if (reader.integer("passes") != state.passes.size()) throw UserError("damaged");
    std::vector<Communication> communication(1);
    reader.take(communication);
    state.communication = communication.front();
    for_each_vector(state, [&](auto& values) { reader.take(values); });
    return state;
}

}  // namespace raya
