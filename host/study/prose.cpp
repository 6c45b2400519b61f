#include "host/study/prose.hpp"

#include <sstream>
#include <stdexcept>

#include "host/embedded.hpp"

namespace raya {
namespace {

const std::string& prose_of(const std::string& name) { return embedded_files().at("host/study/prose/" + name + ".md"); }

}  // namespace

StudyPage page_about(const std::string& name, const Json& settings, const Json& words) {
    const auto value_of = [&](const std::string& word) {
        for (const auto* known : {&words, &settings})
            if (const Json* value = known->find(word)) return value->is_text() ? value->text() : value->dump();
        throw std::logic_error(name + ".md: nothing says what {" + word + "} is");
    };
    const auto filled = [&](const std::string& text) {
        std::string result;
        for (std::size_t at = 0; at < text.size(); ++at) {
            const std::size_t end = text[at] == '{' ? text.find('}', at) : std::string::npos;
            result += end == std::string::npos ? text.substr(at, 1) : value_of(text.substr(at + 1, end - at - 1));
            if (end != std::string::npos) at = end;
        }
        return result;
    };
    StudyPage page{name, {}, {}, {}, settings};
    std::istringstream lines(prose_of(name));
    for (std::string line; std::getline(lines, line) && !line.starts_with("## ");)
        if (line.starts_with("# "))
            page.title = filled(line.substr(2));
        else if (line.starts_with("Beside: "))
            page.beside = line.substr(8);
        else if (line.starts_with("- "))
            page.method.push_back(filled(line.substr(2)));
        else if (!line.empty())
            page.question = filled(line);
    return page;
}

std::string sentence(const std::string& name, const std::string& key) {
    const std::string &prose = prose_of(name), heading = "\n## " + key + "\n\n";
    const std::size_t at = prose.find(heading);
    if (at == std::string::npos) throw std::out_of_range(name + ".md has no '" + key + "'");
    const std::size_t begin = at + heading.size();
    return prose.substr(begin, prose.find('\n', begin) - begin);
}

}  // namespace raya
