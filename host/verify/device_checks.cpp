#include "host/verify/device_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

#include "host/base/json.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {

DeviceChecks device_checks_of(const DeviceInfo& info) {
    return {info.name, info.platform, info.version, info.driver, info.pci_address};
}

Json to_json(const DeviceChecks& device) {
    Json json = Json::object();
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
    const auto text = [&](const char* key) { return json_text(json.at(key)); };
    DeviceChecks device{text("name"), text("platform"), text("version"), text("driver")};
    if (find_member(json, "pci_address")) device.pci_address = text("pci_address");
    device.seconds = json_number(json.at("seconds"));
    for (const Json& check : json_array(json.at("checks"))) device.checks.push_back(check_of(check));
    return device;
}

namespace {

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Returns the text with XML's special characters replaced, and without what XML 1.0 does not allow: control characters
// and bytes that are not UTF-8, which Json::dump() replaces.
std::string xml_text(const std::string& text) {
    std::string all;
    const Json valid = parse_json(json_dump(text), {"a text"});
    for (const char c : json_text(valid)) switch (c) {
            case '&':
                all += "&amp;";
                break;
            case '<':
                all += "&lt;";
                break;
            case '>':
                all += "&gt;";
                break;
            case '"':
                all += "&quot;";
                break;
            case '\n':
                all += "&#10;";
                break;
            default:
                all += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    return all;
}

// Returns the text on one line, with the character # escaped, which starts a directive of TAP.
std::string tap_text(const std::string& text) {
    std::string all;
    for (const char c : text) {
        if (c == '#' || c == '\\') all += '\\';
        all += c == '\n' ? ' ' : c;
    }
    return all;
}

bool is_left_out(Outcome outcome) { return outcome == Outcome::kSkip || outcome == Outcome::kExpectedFail; }

std::string junit_case(const Check& check) {
    const Verdict& v = check.verdict;
    std::string text = fmt::format("    <testcase classname=\"raya.{}\" name=\"{}\" time=\"{:.3f}\"",
                                   xml_text(check.layer), xml_text(check.name), check.seconds);
    if (is_unwanted(v.outcome))
        return text + fmt::format(">\n      <failure message=\"{}\">{}</failure>\n    </testcase>\n",
                                  xml_text(v.result), xml_text(check_lines(check)));
    if (is_left_out(v.outcome))
        return text + fmt::format(">\n      <skipped message=\"{}\"/>\n    </testcase>\n", xml_text(v.result));
    return text + "/>\n";
}

std::string contents_of(const std::filesystem::path& path) {
    try {
        return path.empty() ? "" : read_input(path);
    } catch (const UnreadableFile& error) {
        throw UserError(fmt::format("--expect {}: cannot be read: {}", path.string(), error.what()));
    }
}

// Returns the number of checks with one of two outcomes.
std::size_t sum_of(const DeviceChecks& device, Outcome a, Outcome b) {
    return count_of(device.checks, a) + count_of(device.checks, b);
}

}  // namespace

std::vector<ExpectedFailure> read_expected_failures(const std::filesystem::path& path) {
    std::istringstream text(contents_of(path));
    std::vector<ExpectedFailure> failures;
    std::size_t number = 0;
    for (std::string line; std::getline(text, line);) {
        ++number;
        if (trimmed(line).empty() || trimmed(line).starts_with('#')) continue;
        std::vector<std::string> fields;
        for (std::size_t at = 0; at != std::string::npos;) {
            const std::size_t bar = line.find('|', at);
            fields.push_back(trimmed(line.substr(at, bar - at)));
            at = bar == std::string::npos ? bar : bar + 1;
        }
        if (fields.size() < 2 || fields.size() > 3 || fields[0].empty() || fields[1].empty())
            throw UserError(
                fmt::format("{}:{}: expected PATTERN | REASON or PATTERN | REASON | LINK", path.string(), number));
        failures.push_back(
            {fmt::format("{}:{}", path.string(), number), fields[0], fields[1], fields.size() > 2 ? fields[2] : ""});
    }
    return failures;
}

std::vector<std::string> unmatched_patterns(const std::vector<ExpectedFailure>& failures,
                                            const std::vector<DeviceChecks>& devices) {
    std::vector<std::string> warnings;
    for (const ExpectedFailure& e : failures) {
        const auto is_matched = [&](const DeviceChecks& device) {
            return std::ranges::any_of(device.names, [&](const auto& name) { return name_matches(name, e.pattern); }) ||
                   std::ranges::any_of(device.checks,
                                       [&](const Check& c) { return name_matches(c.layer + " " + c.name, e.pattern); });
        };
        if (std::ranges::none_of(devices, is_matched))
            warnings.push_back(fmt::format("{}: \"{}\" matches no check", e.place, e.pattern));
    }
    return warnings;
}

std::string junit_report(const std::string& command, const std::vector<DeviceChecks>& devices) {
    std::string text =
        fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"{}\">\n", xml_text(command));
    for (const DeviceChecks& device : devices) {
        text += fmt::format(
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\" time=\"{:.3f}\">\n"
            "    <properties>\n      <property name=\"platform\" value=\"{}\"/>\n"
            "      <property name=\"driver\" value=\"{}\"/>\n    </properties>\n",
            xml_text(device.name), device.checks.size(), sum_of(device, Outcome::kFail, Outcome::kUnexpectedPass),
            sum_of(device, Outcome::kSkip, Outcome::kExpectedFail), device.seconds, xml_text(device.platform),
            xml_text(device.driver));
        for (const Check& check : device.checks) text += junit_case(check);
        text += "  </testsuite>\n";
    }
    return text + "</testsuites>\n";
}

std::string tap_report(const std::vector<DeviceChecks>& devices) {
    std::string lines;
    std::size_t number = 0;
    for (const DeviceChecks& device : devices)
        for (const Check& check : device.checks) {
            const Verdict& v = check.verdict;
            lines +=
                fmt::format("{} {} - {} {}{}", has_failed(v.outcome) ? "not ok" : "ok", ++number, tap_text(check.layer),
                            tap_text(check.name), devices.size() > 1 ? " on " + tap_text(device.name) : "");
            if (v.outcome == Outcome::kSkip) lines += " # SKIP " + tap_text(v.result);
            if (has_expectation(v.outcome)) lines += " # TODO " + tap_text(v.result);
            lines += '\n';
            if (v.outcome != Outcome::kFail) continue;
            std::istringstream details(check_lines(check));
            for (std::string line; std::getline(details, line);) lines += "# " + line + '\n';
        }
    return fmt::format("TAP version 14\n1..{}\n", number) + lines;
}

}  // namespace raya
