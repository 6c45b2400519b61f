#include "host/cli/view_options.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/scene/nff_tokens.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
namespace {

constexpr const char* kPoint = "must be three numbers X,Y,Z, each at most 1e30 in magnitude";
constexpr const char* kColour = "must be three numbers R,G,B from 0 to 1e9; 1 is full intensity";
constexpr const char* kLight = "must be a position X,Y,Z, or position and colour X,Y,Z,R,G,B, colours from 0 to 1e9";

constexpr std::size_t kMaxShownBytes = 60;  // maximum bytes of a value in messages

/// Parses comma-separated numbers. Returns an empty vector if a number is malformed or its magnitude exceeds
/// kMaxSceneLength.
std::vector<double> numbers_of(std::string_view text) {
    std::vector<double> numbers;
    while (true) {
        const std::string_view field = text.substr(0, text.find(','));
        double number = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
        const bool is_whole_field = error == std::errc{} && end == field.data() + field.size();
        if (!is_whole_field || !(std::abs(number) <= kMaxSceneLength)) return {};
        numbers.push_back(number);
        if (field.size() == text.size()) return numbers;
        text.remove_prefix(field.size() + 1);
    }
}

[[noreturn]] void refuse(const std::string& option, const std::string& text, const char* legal_values) {
    throw UserError(fmt::format("{} {}: {}", option, text.substr(0, kMaxShownBytes), legal_values));
}

Vec3 vector_of(const std::string& option, const std::string& text, const char* legal_values) {
    const std::vector<double> numbers = numbers_of(text);
    if (numbers.size() != 3) refuse(option, text, legal_values);
    return {numbers[0], numbers[1], numbers[2]};
}

Light light_of(const std::string& text) {
    const std::vector<double> n = numbers_of(text);
    if (n.size() != 3 && n.size() != 6) refuse("--light", text, kLight);
    Light light{{n[0], n[1], n[2]}, {}};
    if (n.size() == 6) light.colour = Colour(n[3], n[4], n[5]);
    if (light.colour && !is_colour(*light.colour)) refuse("--light", text, kLight);
    return light;
}

/// Returns the camera options that were given: "--from 0,0,0 --angle 10".
std::string viewpoint_text(const ViewOptions& v) {
    std::string text;
    for (const auto& [option, value] : v.given_options())
        if (option != "--background" && option != "--light")
            text += fmt::format("{}{} {}", text.empty() ? "" : " ", option, value.substr(0, kMaxShownBytes));
    return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> ViewOptions::given_options() const {
    std::vector<std::pair<std::string, std::string>> options;
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) options.emplace_back(option, value);
    };
    add("--from", from);
    add("--at", at);
    add("--up", up);
    add("--angle", angle ? fmt::format("{}", *angle) : "");
    add("--background", background);
    for (const std::string& light : lights) add("--light", light);
    return options;
}

void add_view_options(CLI::App& command, ViewOptions& v) {
    const OptionGroup group(command, kCamera);
    add_value(command, "--from", v.from,
              "Position of the eye in scene units; default of all six camera and light options: the scene's, "
              "or a view of the whole mesh")
        ->type_name("X,Y,Z");
    add_value(command, "--at", v.at, "Point at the centre of the image")->type_name("X,Y,Z");
    add_value(command, "--up", v.up, "Up direction of the image, of any length")->type_name("X,Y,Z");
    add_value(command, "--angle", v.angle, "Vertical field of view, between 0 and 180 degrees")->type_name("DEGREES");
    add_value(command, "--background", v.background, "Colour of rays that hit nothing; linear, 1 is full intensity")
        ->type_name("R,G,B");
    add_value(
        command, "--light", v.lights,
        "A light at X,Y,Z of colour R,G,B; default colour: white, with the total intensity sqrt(n)/2 for n lights; "
        "repeat the option for several lights; they replace all lights of the scene")
        ->allow_extra_args(false)  // so that the scene may follow
        ->type_name("X,Y,Z[,R,G,B]");
}

void change_viewpoint(const ViewOptions& v, View& view) {
    if (!v.from.empty()) view.from = vector_of("--from", v.from, kPoint);
    if (!v.at.empty()) view.at = vector_of("--at", v.at, kPoint);
    if (!v.up.empty()) view.up = vector_of("--up", v.up, kPoint);
    if (v.angle) view.angle_degrees = *v.angle;
    const std::string given_text = viewpoint_text(v);
    if (given_text.empty()) return;
    const std::string error = view_error(view);
    if (!error.empty()) throw UserError(fmt::format("{}: {}", given_text, error));
}

void change_view(const ViewOptions& v, Scene& scene) {
    change_viewpoint(v, scene.view);
    if (!v.background.empty()) {
        scene.background = vector_of("--background", v.background, kColour);
        if (!is_colour(scene.background)) refuse("--background", v.background, kColour);
    }
    if (v.lights.empty()) return;
    scene.lights.clear();
    for (const std::string& text : v.lights) scene.lights.push_back(light_of(text));
}

}  // namespace raya
