// A JSON document as another program reads it: what tests look at, whatever host/base/json.hpp makes of it.
#pragma once
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/json.hpp"

namespace raya {

using Document = nlohmann::ordered_json;  // two are equal only if their members stand in the same order

inline Document read_back(const Json& json) { return Document::parse(json.dump()); }

/// Of a file.
inline Document json_of(const std::filesystem::path& path) {
    return Document::parse(std::ifstream(path, std::ios::binary));
}

}  // namespace raya
