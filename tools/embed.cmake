# Writes OUTPUT, a C++ file with a map from paths to the texts of the files; see host/embedded.hpp.
#   cmake -DROOT=DIR "-DFILES=PATH|PATH..." -DOUTPUT=FILE -P tools/embed.cmake     FILES: paths below ROOT, separated by |
string(REPLACE "|" ";" files "${FILES}")
set(text "// Made by tools/embed.cmake; edit the files that it contains.\n#include \"host/embedded.hpp\"\n\nnamespace raya {\n\n")
string(APPEND text "const std::map<std::string, std::string>& embedded_files() {\n")
string(APPEND text "    static const std::map<std::string, std::string> files = {\n")
foreach(name IN LISTS files)
    file(READ ${ROOT}/${name} content)
    string(APPEND text "{\"${name}\", R\"raya-file(${content})raya-file\"},\n")
endforeach()
string(APPEND text "    };\n    return files;\n}\n\n}  // namespace raya\n")
file(WRITE ${OUTPUT} "${text}")
