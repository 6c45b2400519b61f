#include "host/cl/kernel_patch.hpp"

#include <fmt/core.h>

#include <stdexcept>

namespace raya {

std::string patched_text(std::string text, const std::string& file, const std::vector<SourcePatch>& patches) {
    for (const SourcePatch& patch : patches) {
        if (patch.file != file) continue;
        const std::size_t at = text.find(patch.find);
        if (patch.find.empty() || at == std::string::npos)
            throw std::logic_error(fmt::format("patch of {}: no text '{}'", file, patch.find));
        if (text.find(patch.find, at + 1) != std::string::npos)
            throw std::logic_error(fmt::format("patch of {}: more than one text '{}'", file, patch.find));
        text.replace(at, patch.find.size(), patch.replace);
    }
    return text;
}

}  // namespace raya
