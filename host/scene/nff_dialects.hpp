// Detection of NFF dialects, mail headers and files of other formats.
#pragma once
#include <cstddef>
#include <string_view>

namespace raya {

/// Returns true if a line looks like an entity of an NFF dialect (`la 0.2 0.2 0.2`, `tt wood.ppm 0 0 1`, `Q`) and not
/// like prose: a short keyword of letters and digits, followed by numbers and file names, and if there are numbers, by
/// at most two other names. `rest`: the line after the keyword.
bool reads_as_entity(std::string_view keyword, std::string_view rest);

/// Returns true if the first token of a text identifies Sense8's NFF, another format of the same name.
bool is_sense8_keyword(std::string_view token);

/// Guesses the format of a text that is not NFF, with its article: "an OBJ", "a PLY", "a glTF", "a POV-Ray" or "a
/// JSON"; empty if unknown.
std::string_view foreign_format(std::string_view text);

struct Header {
    std::size_t bytes = 0;  // 0: no header
    int lines = 0;
};

/// Finds a mail header at the beginning of a text, after empty lines: from `From somebody` or `Name: text` to the next
/// empty line.
Header mail_header(std::string_view text);

}  // namespace raya
