// Parsers of --mapping and --fold.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/model/mapping_rule.hpp"

namespace raya {

/// A static mapping of pixels to PEs, as given on the command line:
///
///     cyclic, cyclic:p   the cyclic mapping with offset p; "cyclic" alone: p from --offset or the machine
///     column             the cyclic mapping with offset 0: whole columns, Kohata & Ito's column split
///     rows               scan lines round robin
///     blocks             contiguous blocks of scan lines
///     grid:AxB           A rows of B PEs; each PE has every B-th pixel of every A-th line
///     tiles:WxH          tiles of W x H pixels round robin; W and H divide the image's sides
///     random:seed        random pixels, the same number for each PE; "random" alone: seed 1
struct MappingText {
    std::string text;                 // as given on the command line
    MappingRule rule{};               // has the cyclic fold; ring_settings() applies --fold
    bool takes_offset_option = true;  // true for "cyclic" without p: --offset sets p

    /// Returns the part of `text` before the colon.
    std::string name() const { return text.substr(0, text.find(':')); }
};

/// Returns the forms of mappings listed above, for messages.
const std::vector<std::string>& mapping_forms();

/// Parses a static mapping. Throws UserError with the option and its legal forms.
MappingText parse_mapping(const std::string& text);

/// Parses "cyclic" or "block". Throws UserError with the option and its legal values.
Fold parse_fold(const std::string& text);

/// Returns true if the text names a dynamic or hybrid mapping, which parse_dynamic() parses.
bool is_dynamic(const std::string& text);

/// Parses "dynamic:chunk[,overhead[,root]]" or "hybrid:chunk[,overhead[,share[,root]]]". `chunk`: pixels per request;
/// `overhead`: cycles of the PE per request; `root`: cycles of the root per request; `share`: fraction of a PE's pixels
/// that is assigned statically, default 0.5 for hybrid. `defaults` supplies the other missing numbers. Throws UserError
/// with the option and its legal forms.
DynamicPlan parse_dynamic(const std::string& text, const DynamicPlan& defaults = {});

}  // namespace raya
