// What files by other people have that is not NFF, and can be told from a file of another kind.
#pragma once
#include <cstddef>
#include <string_view>

namespace raya {

/// Whether a line reads as an entity that somebody has added to NFF (`la 0.2 0.2 0.2`, `tt wood.ppm 0 0 1`, `Q`), not
/// as prose: a short keyword of letters and digits; behind it numbers, names of files, and beside numbers at most two
/// other words. `rest`: the line behind the keyword.
bool reads_as_entity(std::string_view keyword, std::string_view rest);

/// Whether a text with that first word is Sense8's NFF, another format of the same name.
bool opens_sense8(std::string_view word);

/// The format that a text seems to have where that is not NFF, with its article: "an OBJ", "a PLY", "a glTF", "a
/// POV-Ray" or "a JSON"; empty where none of these is likely.
std::string_view foreign_format(std::string_view text);

struct Header {
    std::size_t bytes = 0;  // 0: there is none
    int lines = 0;
};

/// A mail's header with which a text opens, behind empty lines: from `From somebody` or `Name: text` to the next empty
/// line.
Header mail_header(std::string_view text);

}  // namespace raya
