// A camera on its way round what it looks at.
#pragma once
#include "host/scene/scene.hpp"

namespace raya {

/// The view after its eye has gone by so many degrees round the axis through `at` along `up`, anticlockwise for who
/// looks against `up`: at the same height and distance. Whole turns change no bit of it, quarter turns have the exact
/// sine and cosine.
View turned(View view, double degrees);

}  // namespace raya
