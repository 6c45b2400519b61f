// Mappings by name, and where every pixel of a block layout lies. The formulas stand in kernels/shared/mapping.h.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "shared/mapping.h"

namespace raya {

inline constexpr std::uint32_t kLargestSide = 16384;  // pixels

/// "cyclic": the cyclic mapping with its offset. "column": offset 0, Kohata & Ito's column split.
const std::vector<std::string>& mapping_names();

/// Checks and completes a mapping. Throws UserError, naming the option and its legal range, for an unknown mapping or
/// fold, an image side outside 1..16384, PEs outside 1..W*H, an offset outside 0..W-1.
raya_mapping make_mapping(const std::string& name, std::uint32_t width, std::uint32_t height, std::uint32_t pes,
                          std::uint32_t offset, const std::string& fold);

/// Pixels of the PE that owns most.
std::uint32_t largest_share(const raya_mapping& mapping);

}  // namespace raya
