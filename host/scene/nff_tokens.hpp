// Tokens of an NFF file with their line numbers.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace raya {

/// Maximum magnitude of colours, exponents and other numbers that are not lengths.
inline constexpr double kMaxNumber = 1e9;

/// Maximum magnitude of lengths, so that products of four lengths do not overflow a double. The packer scales lengths
/// into the range of the number format.
inline constexpr double kMaxSceneLength = 1e30;

// The byte order mark of UTF-8, which some editors write at the start of a file.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// A run of characters without white space. At the end of the file `text` is empty.
struct NffToken {
    std::string_view text;
    int line = 1;
    bool first_on_line = false;
};

/// Splits a text into tokens. Skips comments (`#` to the end of the line) except `#raya` at the start of a line. Lines
/// may end in LF, CR LF or CR. Every error is a UserError "NAME:LINE: reason".
class NffTokens {
  public:
    /// `text` must outlive this object; its lines are counted from `first_line`. Control characters, as in a binary
    /// file, are an error.
    NffTokens(std::string_view text, std::string name, int first_line = 1);

    /// Moves to the token at `position`, the start of a line, which becomes line 1.
    void start_at(std::size_t position);

    /// Moves to where `piece` is. `piece` is another reader of the same text that started at this reader's next token.
    void continue_after(const NffTokens& piece);

    /// The whole text, without a byte order mark.
    std::string_view text() const { return text_; }

    /// Index of the next token in text().
    std::size_t next_at() const { return position_ - next_.text.size(); }

    /// Returns the next token without taking it.
    const NffToken& peek() const { return next_; }

    /// Takes the keyword of the next entity. The keyword must be the first token of a line. An entity that starts with
    /// `#raya` must end on the same line.
    std::string_view take_keyword();

    /// Takes the name after `#raya`, or a label inside the viewpoint entity `v`, such as `from`; `what` describes it in
    /// messages.
    std::string_view take_name(std::string_view what);

    /// Takes a finite number of at most `max` in magnitude; `what` describes it in messages ("the radius").
    double take_number(std::string_view what, double max = kMaxNumber);

    /// Takes an integer in [lowest, highest]; `what` describes it in messages.
    int take_integer(std::string_view what, int lowest, int highest);

    /// Skips an unknown entity: the rest of its line and all following lines that begin with a number. Returns false
    /// and skips nothing if the line does not look like an entity (reads_as_entity()).
    bool skip_unknown();

    /// Returns true if the next token starts with a number; more characters may follow it.
    bool number_follows() const;

    int entity_line() const { return entity_line_; }  // line on which the current entity started

    /// Returns the number of characters after the next token.
    std::size_t characters_left() const { return text_.size() - position_; }

    /// Throws UserError "NAME:LINE: reason".
    [[noreturn]] void refuse(int line, std::string_view reason) const;

  private:
    void advance();
    void skip_blanks_and_comments();
    [[noreturn]] void refuse_binary() const;
    bool is_at_directive() const;
    NffToken take_part(std::string_view what);

    std::string_view text_;
    std::string name_;
    std::size_t position_ = 0;  // index of the first character after next_
    int line_ = 1;
    bool at_line_start_ = true;
    NffToken next_;
    std::string entity_;  // the current entity's name in messages
    int entity_line_ = 1;
    bool one_line_ = false;  // true if the current entity must end on the line on which it starts
};

/// Returns true if a token starts with a number; more characters may follow it.
bool reads_as_number(std::string_view token);

/// Returns the text in single quotes, shortened to 24 characters, with '?' for each character that is not printable
/// ASCII.
std::string in_quotes(std::string_view text);

// Detection of NFF dialects, mail headers and files of other formats.

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
