// Tuned values as JSON: in files, and between processes.
#pragma once
#include "host/base/json.hpp"
#include "host/cl/tuned.hpp"

namespace raya {

Json to_json(const TunedValues& values);

/// JsonError where a value is missing or no whole number of 32 bits.
TunedValues values_of(const Json& json);

}  // namespace raya
