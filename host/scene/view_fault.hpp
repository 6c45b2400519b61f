// What a viewpoint and colours must be, whoever gives them: a scene's file or the command line.
#pragma once
#include <string>

#include "host/scene/scene.hpp"

namespace raya {

/// Why nothing can be seen from there: "'from' and 'at' are the same point"; empty where it can.
std::string view_fault(const View& view);

/// Whether light can have that colour: components from 0 to kLargestNumber.
bool is_colour(const Colour& colour);

}  // namespace raya
