// JSON documents for tests, parsed by nlohmann::json, which is independent of host/base/json.hpp.
#pragma once
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/json.hpp"

namespace raya {

using Document = nlohmann::ordered_json;  // equality requires the same order of members

inline Document read_back(const Json& json) { return Document::parse(json.dump()); }

inline Document json_of(const std::filesystem::path& path) {
    return Document::parse(std::ifstream(path, std::ios::binary));
}

}  // namespace raya
