#include "host/page/html_document.hpp"

#include <fmt/core.h>

#include "host/embedded.hpp"
#include "host/page/html.hpp"

namespace raya {
namespace {

// The policy holds the document to its word: a browser refuses whatever it would have to fetch.
constexpr const char* kHead = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'">
)";

std::string element(const char* tag, const std::string& file) {
    return fmt::format("<{0}>\n{1}</{0}>\n", tag, embedded_files().at(file));
}

}  // namespace

std::string html_document(const HtmlDocument& document) {
    std::string html = kHead + fmt::format("<title>{}</title>\n", html_text(document.title));
    html += element("style", "host/page/assets/style.css");
    for (const std::string& file : document.styles) html += element("style", file);
    html += "</head>\n<body>\n" + document.html;
    for (const std::string& file : document.scripts) html += element("script", file);
    return html + "</body>\n</html>\n";
}

}  // namespace raya
