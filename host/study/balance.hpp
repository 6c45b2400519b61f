// One pass over one scene, a PE for each column: what Figs 7, 8, 12 and 13 are made of.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"

namespace raya {

struct BalancePass {
    std::string scene;
    std::uint32_t size;
    bool first;  // the first pass, else supersampling alone
    Ensemble ensemble;

    const CostImage& image(const Costs& costs) const { return first ? costs.trace : costs.supersample; }
    const char* phase() const { return first ? "first pass" : "supersampling alone"; }
    bool in_paper() const { return first && as_in_paper(scene, size); }
    std::optional<double> paper(double value) const { return in_paper() ? std::optional<double>(value) : std::nullopt; }
};

/// Of the scene for studies of one, in the laboratory's size, else 256. Throws as Laboratory::costs().
BalancePass balance_pass(Laboratory& lab, const Scenes& scenes, AntialiasMethod method);

/// What pages say of it: scene, size, PEs, number and seeds of the views.
Json settings_of(const BalancePass& pass);

}  // namespace raya
