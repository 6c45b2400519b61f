#include "host/study/balance.hpp"

#include "host/scene/random_view.hpp"

namespace raya {

BalancePass balance_pass(Laboratory& lab, const Scenes& scenes, AntialiasMethod method) {
    const LabelledScene scene = one_of(scenes);
    const std::uint32_t size = lab.size(256);
    return {scene.label, size, method == AntialiasMethod::kNone, ensemble_of(lab, scene, size, method)};
}

Json settings_of(const BalancePass& pass) {
    return {{"scene", pass.scene},
            {"size", pass.size},
            {"pes", pass.size},
            {"views", pass.ensemble.views.size()},
            {"view_seeds", fmt::format("1..{}", pass.ensemble.views.size())},
            {"lowest_view_degrees", kLowestView},
            {"highest_view_degrees", kHighestView}};
}

}  // namespace raya
