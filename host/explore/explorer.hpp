// The explorer: what a render's pixels cost, as a page in which mapping, offset and number of PEs can be dragged.
#pragma once
#include <string>

#include "host/image/image.hpp"
#include "host/model/machine.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/ring/schedule.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

struct Exploration {
    std::string scene;       // its file, as the user calls it
    std::string command;     // that renders the same picture, but for mapping and PEs
    std::string settings;    // of the render, for people: "spa, e6m15, 8 bounces"
    std::string made;        // what made the page: a sentence
    Machine machine;         // whose rates give the modelled times
    raya_mapping mapping{};  // that the page opens with
    CostImage cost;          // of one size with the mapping and the image
    Image image;
};

/// Refuses an image of which no page below kLargestPage could be made, before it is rendered. UserError.
void check_explorable(const ImageSize& size);

/// The page: one file that asks for nothing from anywhere, and says its figures without scripts, too. UserError where
/// it would be larger than kLargestPage, or its cycles too many for a page's arithmetic.
std::string explorer_html(const Exploration& exploration);

}  // namespace raya
