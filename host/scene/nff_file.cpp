#include <fmt/core.h>

#include "host/base/read_file.hpp"
#include "host/base/standard_streams.hpp"
#include "host/error.hpp"
#include "host/scene/nff_dialects.hpp"
#include "host/scene/nff_reader.hpp"

namespace raya {

Scene read_nff(const std::filesystem::path& path, std::vector<NffRemark>* remarks) {
    std::string text;
    try {
        text = read_file(path, Pipes::kRead);
        return parse_nff(text, input_name(path), remarks);
    } catch (const UnreadableFile& error) {
        throw UserError(fmt::format("{}: cannot read the scene: {}", input_name(path), error.what()));
    } catch (const UserError&) {
        const std::string_view format = foreign_format(text);
        if (format.empty()) throw;
        if (remarks) remarks->clear();
        throw UserError(fmt::format("{}:1: this looks like {} file; raya reads NFF", input_name(path), format));
    }
}

}  // namespace raya
