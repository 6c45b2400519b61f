// What a study says before it has counted anything: title, question and method, from the project's host/study/prose/.
#pragma once
#include <string>

#include "host/study/page.hpp"

namespace raya {

/// The page of the study NAME with its settings, and with title, question and method of NAME.md: a heading, a
/// paragraph, a list. A word in braces there is filled from the settings, or else from `words`. std::logic_error for
/// one that neither has.
StudyPage page_about(const std::string& name, const nlohmann::ordered_json& settings,
                     const nlohmann::ordered_json& words = {});

}  // namespace raya
