// A study's prose, from the project's host/study/prose/: what it says before it has counted anything, title, question
// and method; and its findings, sentences in which figures are wanting.
#pragma once
#include <fmt/format.h>

#include <string>

#include "host/study/page.hpp"

namespace raya {

/// The page of the study NAME with its settings, and with title, question and method of NAME.md: a heading, a
/// paragraph, a list; and, after "Beside: ", whose figures it compares with. A word in braces there is filled from the
/// settings, or else from `words`. std::logic_error for one that neither has.
StudyPage page_about(const std::string& name, const Json& settings, const Json& words = {});

using fmt::literals::operator""_a;

/// The sentence under "## KEY" in NAME.md. std::out_of_range where there is none.
std::string sentence(const std::string& name, const std::string& key);

/// The same with its figures, each by the name and in the digits that the sentence asks for: {loss:.1f} is
/// "loss"_a = 3.14. Throws fmt::format_error for a figure that is not given.
template <class... Figures>
std::string finding(const std::string& name, const std::string& key, const Figures&... figures) {
    return fmt::vformat(sentence(name, key), fmt::make_format_args(figures...));
}

}  // namespace raya
