// --mapping and --fold as they are written.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/model/mapping_rule.hpp"

namespace raya {

/// A static mapping:
///
///     cyclic, cyclic:p   the cyclic mapping, p slots a row; "cyclic" alone leaves p to the machine or --offset
///     column             offset 0, Kohata & Ito's column split
///     rows, blocks       scan lines in turn; contiguous scan lines
///     grid:AxB           A rows of B PEs: every A-th line, every B-th pixel of it
///     tiles:WxH          tiles of W x H pixels in turn; W and H divide the image's sides
///     random:seed        each pixel at random, shares even; "random" alone: seed 1
struct MappingText {
    std::string text;           // as it was given
    MappingRule rule{};         // of slots: with the cyclic fold
    bool leaves_offset = true;  // "cyclic" alone

    /// Without what follows the colon.
    std::string name() const { return text.substr(0, text.find(':')); }
};

/// The forms above, for messages.
const std::vector<std::string>& mapping_forms();

/// Throws UserError, naming the option and the legal forms.
MappingText parse_mapping(const std::string& text);

/// "cyclic" or "block"; UserError as above.
Fold parse_fold(const std::string& text);

/// Whether the text is that of a distribution for parse_dynamic().
bool is_dynamic(const std::string& text);

/// "dynamic:chunk[,overhead]" or "hybrid:chunk[,overhead[,share]]"; overhead 0 and share 0.5 where absent.
/// Throws UserError with the value of --mapping and what is legal.
DynamicPlan parse_dynamic(const std::string& text);

}  // namespace raya
