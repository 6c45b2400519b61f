// Mappings by name, and where every pixel of a block layout lies. The formulas stand in kernels/shared/mapping.h.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernels/shared/mapping.h"

namespace raya {

inline constexpr std::uint32_t kLargestSide = 16384;  // pixels

/// A mapping as it is written, before an image and PEs are known:
///
///     cyclic, cyclic:p   the cyclic mapping, p slots a row; "cyclic" alone leaves p to the machine or --offset
///     column             offset 0, Kohata & Ito's column split
///     rows, blocks       scan lines in turn; contiguous scan lines
///     grid:AxB           A rows of B PEs: every A-th line, every B-th pixel of it
///     tiles:WxH          tiles of W x H pixels in turn; W and H divide the image's sides
///     random:seed        each pixel at random, shares even; "random" alone: seed 1
struct MappingText {
    std::string text;                        // as it was given
    std::string name;                        // without what follows the colon
    std::uint32_t kind = RAYA_FOLD_CYCLIC;   // RAYA_FOLD_CYCLIC for both folds of a slot mapping
    std::optional<std::uint32_t> parameter;  // of raya_mapping; empty: "cyclic" alone

    bool has_slots() const { return kind <= RAYA_FOLD_BLOCK; }
    /// A B of a grid; empty for the mappings that go with any number of PEs.
    std::optional<std::uint32_t> pes() const;
};

/// The forms above, for messages.
const std::vector<std::string>& mapping_forms();

/// Throws UserError, naming the option and the legal forms.
MappingText parse_mapping(const std::string& text);

/// Checks and completes a mapping. `offset`: p of "cyclic" alone; `fold`: "cyclic" or "block", of slots. Both say
/// nothing to other mappings. Throws UserError, naming the option and its legal range, for a text that parse_mapping
/// refuses, an unknown fold, an image side outside 1..16384, PEs outside 1..W*H or other than the grid's, an offset
/// outside 0..W-1, tiles that do not divide the image.
raya_mapping make_mapping(const std::string& text, std::uint32_t width, std::uint32_t height, std::uint32_t pes,
                          std::uint32_t offset, const std::string& fold);

/// The text from which make_mapping makes the same mapping, given image, PEs and fold: "cyclic:16", "grid:16x16". One
/// text for each mapping: the column split is "cyclic:0".
std::string mapping_text(const raya_mapping& mapping);

/// Pixels of the PE that owns most.
std::uint32_t largest_share(const raya_mapping& mapping);

}  // namespace raya
