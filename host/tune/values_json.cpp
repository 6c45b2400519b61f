#include "host/tune/values_json.hpp"

namespace raya {

Json to_json(const TunedValues& values) {
    Json json = Json::object();
    for (const auto& [name, value] : kTunedNames) json[name] = values.*value;
    return json;
}

TunedValues values_of(const Json& json) {
    TunedValues values;
    for (const auto& [name, value] : kTunedNames)
        values.*value = static_cast<std::uint32_t>(json.at(name).whole(UINT32_MAX));
    return values;
}

}  // namespace raya
