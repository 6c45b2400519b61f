// Parsers of --mapping and --fold.
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
///     rows, blocks       scan lines round robin; contiguous scan lines
///     grid:AxB           A rows of B PEs: every A-th line, every B-th pixel of it
///     tiles:WxH          tiles of W x H pixels round robin; W and H divide the image's sides
///     random:seed        each pixel at random, shares even; "random" alone: seed 1
struct MappingText {
    std::string text;           // as given
    MappingRule rule{};         // of slots: with the cyclic fold
    bool leaves_offset = true;  // "cyclic" alone

    /// The text before the colon.
    std::string name() const { return text.substr(0, text.find(':')); }
};

/// The forms above, for messages.
const std::vector<std::string>& mapping_forms();

/// UserError with the option and its legal forms.
MappingText parse_mapping(const std::string& text);

/// "cyclic" or "block"; UserError as above.
Fold parse_fold(const std::string& text);

/// True for the texts that parse_dynamic() parses.
bool is_dynamic(const std::string& text);

/// "dynamic:chunk[,overhead]" or "hybrid:chunk[,overhead[,share]]"; default: overhead 0, share 0.5. UserError with the
/// option and its legal forms.
DynamicPlan parse_dynamic(const std::string& text);

}  // namespace raya
