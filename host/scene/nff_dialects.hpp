// Detection of NFF dialects, mail headers and files of other formats.
#pragma once
#include <cstddef>
#include <string_view>

namespace raya {

/// Returns true if a line looks like an entity of an NFF dialect (`la 0.2 0.2 0.2`, `tt wood.ppm 0 0 1`, `Q`) and not
/// like prose: a keyword of at most eight letters, digits and underscores, then any number of numbers and file names.
/// A line with numbers may also contain up to two names that are not file names. `rest`: the line after the keyword.
bool reads_as_entity(std::string_view keyword, std::string_view rest);

/// Returns true if `token`, the first token of a file, identifies the file as Sense8's NFF, a different format with the
/// same name.
bool is_sense8_keyword(std::string_view token);

/// Guesses the format of a text that is not NFF. Returns the format's name with an article ("an OBJ", "a PLY", "a
/// glTF", "a POV-Ray" or "a JSON"), or an empty string if the format is unknown.
std::string_view foreign_format(std::string_view text);

/// Length of a mail header, including the empty lines before it.
struct MailHeader {
    std::size_t bytes = 0;  // 0: no header
    int lines = 0;          // number of lines
};

/// Finds a mail header at the beginning of a text. The header may follow empty lines, starts with a line `From
/// somebody` or `Name: text`, and ends before the next empty line.
MailHeader mail_header(std::string_view text);

}  // namespace raya
