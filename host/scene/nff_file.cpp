#include <fmt/core.h>

#include "host/error.hpp"
#include "host/files/read_file.hpp"
#include "host/files/standard_streams.hpp"
#include "host/scene/nff_reader.hpp"

namespace raya {

Scene read_nff(const std::filesystem::path& path, std::vector<NffRemark>* remarks) {
    try {
        return parse_nff(read_file(path, Pipes::kRead), input_name(path), remarks);
    } catch (const UnreadableFile& error) {
        throw UserError(fmt::format("{}: cannot read the scene: {}", input_name(path), error.what()));
    }
}

}  // namespace raya
