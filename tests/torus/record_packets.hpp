// Renders on a torus and records every packet that a node sends to another node.
#pragma once
#include <vector>

#include "tests/torus/render_torus.hpp"

namespace raya {

struct RecordedRender {
    TorusResult result;
    std::vector<PacketRecord> records;
};

inline RecordedRender render_and_record(Session& session, const Scene& scene, const TorusCase& c) {
    RecordedRender r;
    r.result = render_torus(session, scene, c, [&](const PacketRecord& p) { r.records.push_back(p); });
    return r;
}

inline std::uint32_t state_of(const PacketRecord& p) { return p.head.state; }
inline std::uint32_t kind_of(const PacketRecord& p) { return raya_state_kind(state_of(p)); }

}  // namespace raya
