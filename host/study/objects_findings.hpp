// What Fig. 4's renders say: of the paper's claims, and in sentences.
#pragma once
#include <string>
#include <vector>

#include "host/study/objects_runs.hpp"
#include "host/study/page.hpp"

namespace raya {

/// Of Yoshitani & Yamazaki, by their protocol. `growth` as of growth_rows().
std::vector<Claim> objects_claims(const ObjectsRatios& ratios, const std::vector<GrowthRow>& growth);

std::vector<std::string> objects_findings(const ObjectsRuns& all, const ObjectsRatios& ratios,
                                          const std::vector<GrowthRow>& growth);

}  // namespace raya
