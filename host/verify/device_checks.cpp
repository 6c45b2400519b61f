#include "host/verify/device_checks.hpp"

#include <fmt/core.h>

namespace raya {

std::string DeviceChecks::title() const {
    if (!rank) return name;
    return fmt::format("rank {} on {}: {}{}", *rank, host, name, pci_address.empty() ? "" : ", PCI " + pci_address);
}

DeviceChecks device_checks_of(const DeviceInfo& info) {
    return {info.name, info.platform, info.version, info.driver, info.pci_address};
}

Json to_json(const DeviceChecks& device) {
    Json json = Json::object();
    if (device.rank) json["rank"] = *device.rank;
    if (device.rank) json["host"] = device.host;
    json["name"] = device.name;
    json["platform"] = device.platform;
    json["version"] = device.version;
    json["driver"] = device.driver;
    if (!device.pci_address.empty()) json["pci_address"] = device.pci_address;
    json["right"] = device.all_passed();
    json["passed"] = count_of(device.checks, Outcome::kPass);
    json["failed"] = count_of(device.checks, Outcome::kFail);
    json["skipped"] = count_of(device.checks, Outcome::kSkip);
    json["failed_as_expected"] = count_of(device.checks, Outcome::kExpectedFail);
    json["passed_unexpectedly"] = count_of(device.checks, Outcome::kUnexpectedPass);
    json["seconds"] = device.seconds;
    json["checks"] = Json::array();
    for (const Check& check : device.checks) json["checks"].push_back(to_json(check));
    return json;
}

DeviceChecks device_checks_of(const Json& json) {
    const auto text = [&](const char* key) { return json.at(key).text(); };
    DeviceChecks device{text("name"), text("platform"), text("version"), text("driver")};
    if (json.find("pci_address")) device.pci_address = text("pci_address");
    if (json.find("rank")) device.rank = static_cast<std::uint32_t>(json.at("rank").integer(UINT32_MAX));
    if (json.find("rank")) device.host = text("host");
    device.seconds = json.at("seconds").number();
    for (const Json& check : json.at("checks").elements()) device.checks.push_back(check_of(check));
    return device;
}

}  // namespace raya
