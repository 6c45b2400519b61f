// The words and numbers of an NFF file, with the line on which each stands.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace raya {

/// The largest colour, exponent or other number without a unit.
inline constexpr double kLargestNumber = 1e9;

/// The largest length. The packer scales lengths into a format's range; products of four must fit double precision.
inline constexpr double kLargestLength = 1e30;

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // of UTF-8, which some editors write first

/// A run of characters without white space. At the end of the file `text` is empty.
struct NffToken {
    std::string_view text;
    int line = 1;
    bool first_on_line = false;
};

/// Splits a text into tokens, leaving out comments (`#` to the end of the line) except `#raya` at the start of a line.
/// Lines may end in LF, CR LF or CR. Every refusal is a UserError "NAME:LINE: reason".
class NffTokens {
  public:
    /// `text` must outlive this object; its lines are counted from `first_line`. Refuses a text with control
    /// characters: it is a binary file.
    NffTokens(std::string_view text, std::string name, int first_line = 1);

    /// The next token, which stays the next one.
    const NffToken& peek() const { return next_; }

    /// Starts an entity: takes its keyword, which must be the first word of a line. What `#raya` starts must end on its
    /// line.
    std::string_view take_keyword();

    /// Takes the word after `#raya`, or one of the words in `v`; `what` names it in messages.
    std::string_view take_word(std::string_view what);

    /// Takes a finite number of at most `most` in magnitude; `what` names it in messages ("the radius").
    double take_number(std::string_view what, double most = kLargestNumber);

    /// Takes a number that must be whole and lie in [lowest, highest].
    int take_integer(std::string_view what, int lowest, int highest);

    /// Takes the rest of an entity that raya does not know: of its line, and all lines after it that begin with a
    /// number. False where that line does not read as an entity; then nothing is taken.
    bool skip_unknown();

    /// Whether the next token reads as a number, be it a good one or not.
    bool number_follows() const;

    /// The line on which the entity in progress started.
    int entity_line() const { return entity_line_; }

    /// The characters that are left after the next token.
    std::size_t characters_left() const { return text_.size() - position_; }

    /// Throws UserError "NAME:LINE: reason".
    [[noreturn]] void refuse(int line, std::string_view reason) const;

  private:
    void advance();
    void skip_blanks_and_comments();
    bool directive_here() const;
    NffToken take_part(std::string_view what);

    std::string_view text_;
    std::string name_;
    std::size_t position_ = 0;
    int line_ = 1;
    bool at_line_start_ = true;
    NffToken next_;
    std::string entity_;  // as it is named in messages
    int entity_line_ = 1;
    bool one_line_ = false;
};

/// Whether a word reads as a number, be it a good one or not.
bool reads_as_number(std::string_view word);

/// The text in quotes, shortened, with characters that cannot be shown as '?'.
std::string in_quotes(std::string_view text);

}  // namespace raya
