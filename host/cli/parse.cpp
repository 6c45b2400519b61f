#include "host/cli/parse.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "host/base/encoding.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/scene/polygon.hpp"

namespace raya {

std::vector<std::uint32_t> parse_sizes(const std::string& text, char separator) {
    constexpr std::uint32_t kMaxSize = 1'000'000;  // so that the product of three sizes fits in 64 bits
    std::vector<std::uint32_t> sizes;
    for (const std::string& part : split(text, separator)) {
        const auto size = parsed_number<std::uint32_t>(part);
        if (!size || *size < 1 || *size > kMaxSize) return {};
        sizes.push_back(*size);
    }
    return sizes;
}

ImageSize parse_image_size(const std::string& text) {
    const std::vector<std::uint32_t> sides = parse_sizes(text);
    if (sides.empty() || sides.size() > 2)
        throw UserError(fmt::format("--size {}: must be N or WxH, 1..{} pixels a side", text, kMaxSide));
    return {sides.front(), sides.back()};
}

std::array<std::uint32_t, 3> parse_three_sides(const std::string& option, const std::string& text,
                                               const std::string& legal_values) {
    const std::vector<std::uint32_t> sides = parse_sizes(text);
    if (sides.size() != 3) throw UserError(fmt::format("{} {}: must be XxYxZ, {}", option, text, legal_values));
    return {sides[0], sides[1], sides[2]};
}

Accel parse_accel(const std::string& text) {
    if (text == "none") return {};
    if (text == "bvh") return {.kind = AccelKind::kBvh};
    if (text == "grid") return {.kind = AccelKind::kGrid, .divisions = {}};
    const std::vector<std::uint32_t> sides =
        text.starts_with("grid:") ? parse_sizes(text.substr(5)) : std::vector<std::uint32_t>{};
    if (sides.size() != 3)
        throw UserError(
            fmt::format("--accel {}: must be none, bvh, grid or grid:AxBxC with A, B, C voxels along x, y, z", text));
    return {.kind = AccelKind::kGrid, .divisions = Divisions{sides[0], sides[1], sides[2]}};
}

std::vector<NumberFormat> parse_formats(const std::string& list) {
    std::vector<NumberFormat> formats;
    for (const std::string& name : split(list, ',')) formats.push_back(parse_format(name));
    return formats;
}

void add_device_option(CLI::App& command, std::string& device) {
    const OptionGroup group(command, kKernels);
    add_value(command, "--device NAME", device,
              "OpenCL device: its number, type (gpu, cpu), or part of its name or version, as raya devices lists them; "
              "default: RAYA_DEVICE, else the first GPU, else the first CPU",
              "OpenCL device: its number, type or part of its name");
}

namespace {

// Returns the integer in `text`; empty if `text` is not an integer in min..max.
std::optional<std::uint32_t> parse_number(std::string_view text, std::uint32_t min, std::uint32_t max) {
    const auto number = parsed_number<std::uint32_t>(text);
    return number >= min && number <= max ? number : std::nullopt;
}

// Returns raya_pair(4, 8) for "4x8"; empty if `text` is not two numbers in 1..kMaxSide.
std::optional<std::uint32_t> parse_pair(std::string_view text) {
    const std::vector<std::string> sides = split(text, 'x');
    const auto side = [&](std::size_t i) { return parse_number(sides[i], 1, kMaxSide); };
    return sides.size() == 2 && side(0) && side(1) ? std::optional(raya_pair(*side(0), *side(1))) : std::nullopt;
}

constexpr std::uint32_t kDefaultSeed = 1;
constexpr std::uint32_t kMaxSeed = std::numeric_limits<std::uint32_t>::max();

// Returns the mapping's parameter. `text`: the part of mapping.text after the colon. Throws UserError with the legal
// form.
std::uint32_t parse_parameter(const MappingText& mapping, std::string_view text) {
    std::optional<std::uint32_t> parameter;
    std::string legal_form = mapping.name() + ", without a parameter";
    if (mapping.rule.kind == RAYA_GRID) {
        parameter = parse_pair(text);
        legal_form = fmt::format("grid:AxB with A rows of B PEs, A and B 1..{}", kMaxSide);
    } else if (mapping.rule.kind == RAYA_TILES) {
        parameter = parse_pair(text);
        legal_form = fmt::format("tiles:WxH with the sides of a tile in pixels, each 1..{}", kMaxSide);
    } else if (mapping.rule.kind == RAYA_RANDOM) {
        parameter = parse_number(text, 0, kMaxSeed);
        legal_form = fmt::format("random:seed with a seed 0..{}, or random", kMaxSeed);
    } else if (mapping.takes_offset_option) {
        parameter = parse_number(text, 0, kMaxSide - 1);
        legal_form = "cyclic:p with an offset p 0..W-1, less than the image's width, or cyclic";
    }
    if (!parameter) throw UserError(fmt::format("--mapping {}: must be {}", mapping.text, legal_form));
    return *parameter;
}

[[noreturn]] void refuse_dynamic_mapping(const std::string& text) {
    throw UserError(
        fmt::format("--mapping {}: must be dynamic:CHUNK[,OVERHEAD[,ROOT]] or hybrid:CHUNK[,OVERHEAD[,SHARE[,ROOT]]] "
                    "with CHUNK 1..{} pixels per request, OVERHEAD 0..{} cycles of the PE per request, ROOT 0..{} "
                    "cycles of the root per request, SHARE 0..1 of the pixels assigned statically",
                    text, kMaxChunk, kMaxOverhead, kMaxOverhead));
}

}  // namespace

MappingText parse_mapping(const std::string& text) {
    struct KnownMapping {
        const char* name;
        MappingRule rule;  // rule of the mapping without a parameter
        bool needs_parameter = false, takes_offset_option = false;
    };
    static const KnownMapping known_mappings[] = {{"cyclic", cyclic_mapping(0), false, true},
                                                  {"column", column_mapping()},
                                                  {"rows", rows_mapping()},
                                                  {"blocks", blocks_mapping()},
                                                  {"grid", grid_mapping(1, 1), true},
                                                  {"tiles", tiles_mapping(1, 1), true},
                                                  {"random", random_mapping(kDefaultSeed)}};
    const std::size_t colon = text.find(':');
    const auto* const found = std::find_if(std::begin(known_mappings), std::end(known_mappings),
                                           [&](const KnownMapping& n) { return n.name == text.substr(0, colon); });
    if (found == std::end(known_mappings))
        throw UserError(fmt::format(
            "--mapping {}: no such mapping; mappings: cyclic, cyclic:p, column, rows, blocks, grid:AxB, tiles:WxH, "
            "random:seed, dynamic:CHUNK, hybrid:CHUNK",
            text));
    MappingText mapping{text, found->rule, found->takes_offset_option};
    if (colon == std::string::npos && !found->needs_parameter) return mapping;
    mapping.rule.parameter = parse_parameter(mapping, colon == std::string::npos ? "" : text.substr(colon + 1));
    mapping.takes_offset_option = false;
    return mapping;
}

bool is_dynamic(const std::string& text) { return text.starts_with("dynamic") || text.starts_with("hybrid"); }

DynamicPlan parse_dynamic(const std::string& text, const DynamicPlan& defaults) {
    const std::string_view view = text;
    const bool hybrid = view.starts_with("hybrid:");
    if (!hybrid && !view.starts_with("dynamic:")) refuse_dynamic_mapping(text);
    const std::vector<std::string> fields = split(view.substr(view.find(':') + 1), ',');
    const auto reads = [&](std::size_t field, auto& value) {
        const auto number = parsed_number<std::remove_reference_t<decltype(value)>>(fields[field]);
        value = number.value_or(value);
        return number.has_value();
    };
    DynamicPlan plan = defaults;
    if (hybrid) plan.static_fraction = 0.5;
    const std::size_t root_index = hybrid ? 3 : 2;  // index of the field ROOT
    const bool is_valid = fields.size() <= root_index + 1 && reads(0, plan.chunk) &&
                          (fields.size() < 2 || reads(1, plan.overhead)) &&
                          (fields.size() < 3 || !hybrid || reads(2, plan.static_fraction)) &&
                          (fields.size() <= root_index || reads(root_index, plan.root_cycles));
    if (!is_valid || !is_valid_plan(plan)) refuse_dynamic_mapping(text);
    return plan;
}

namespace {

constexpr const char* kPoint = "must be three numbers X,Y,Z, each at most 1e30 in magnitude";
constexpr const char* kColour = "must be three numbers R,G,B from 0 to 1e9; 1 is full intensity";
constexpr const char* kLight = "must be a position X,Y,Z, or position and colour X,Y,Z,R,G,B, colours from 0 to 1e9";

constexpr std::size_t kMaxShownBytes = 60;  // maximum bytes of a value in messages

/// Parses comma-separated numbers. Returns an empty vector if a number is malformed or its magnitude exceeds
/// kMaxSceneLength.
std::vector<double> numbers_of(std::string_view text) {
    std::vector<double> numbers;
    for (const std::string& field : split(text, ',')) {
        const auto number = parsed_number<double>(field);
        if (!number || !(std::abs(*number) <= kMaxSceneLength)) return {};
        numbers.push_back(*number);
    }
    return numbers;
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

/// Applies the camera options to `view`. Throws UserError with the options' names for an invalid camera.
void change_viewpoint(const ViewOptions& v, View& view) {
    if (!v.from.empty()) view.from = vector_of("--from", v.from, kPoint);
    if (!v.at.empty()) view.at = vector_of("--at", v.at, kPoint);
    if (!v.up.empty()) view.up = vector_of("--up", v.up, kPoint);
    if (v.angle) view.angle_degrees = *v.angle;
    const std::string error = view_error(view);
    if (!error.empty()) throw UserError("--from, --at, --up, --angle: " + error);
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
    add_value(command, "--from X,Y,Z", v.from,
              "Position of the eye in scene units; default of all six camera and light options: the scene's, "
              "or a view of the whole mesh");
    add_value(command, "--at X,Y,Z", v.at, "Point at the centre of the image");
    add_value(command, "--up X,Y,Z", v.up, "Up direction of the image, of any length");
    add_value(command, "--angle DEGREES", v.angle, "Vertical field of view, between 0 and 180 degrees");
    add_value(command, "--background R,G,B", v.background,
              "Colour of rays that hit nothing; linear, 1 is full intensity");
    add_value(
        command, "--light X,Y,Z[,R,G,B]", v.lights,
        "A light at X,Y,Z of colour R,G,B; default colour: white, with the total intensity sqrt(n)/2 for n lights; "
        "repeat the option for several lights; they replace all lights of the scene")
        ->allow_extra_args(false);  // so that the scene may follow
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

namespace {

/// Returns the innermost selected command. Appends its path without the program's name, " generate balls", to `path`.
const CLI::App& selected_command(const CLI::App& program, std::string& path) {
    const CLI::App* command = &program;
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
        path += ' ' + command->get_name();
    }
    return *command;
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

std::string failure_reason(const CLI::App& program, const CLI::App& command, const CLI::ParseError& error,
                           const std::vector<std::string>& arguments) {
    const bool is_required = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    const std::vector<std::string> commands = command_names(command);
    std::vector<std::string> unparsed;
    if (is_required || dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) unparsed = program.remaining(true);
    const auto first = std::ranges::find_if(arguments, [&](const std::string& argument) {
        return argument != "--" && std::ranges::find(unparsed, argument) != unparsed.end();
    });
    if (first != arguments.end() && first->starts_with("-") && first->size() > 1) {
        const std::string name = first->substr(0, first->find('='));
        return fmt::format("no option {}{}", name, did_you_mean(name, option_names(command)));
    }
    if (first != arguments.end() && commands.empty()) return fmt::format("unexpected argument '{}'", *first);
    if (first != arguments.end() && command.get_option_no_throw("--" + *first) != nullptr)
        return fmt::format("no command {} (did you mean --{}?)", *first, *first);
    if (first != arguments.end())
        return fmt::format("no command {}{}; commands: {}", *first, did_you_mean(*first, commands),
                           fmt::join(commands, ", "));
    if (is_required && !commands.empty())
        return fmt::format("command missing; commands: {}", fmt::join(commands, ", "));
    std::string text = error.what();
    for (const auto& [old_text, new_text] :
         {std::pair{"At Most 1 required but received", "takes one value, not"},  // CLI11 2.2
          {"At most 1 required but received", "takes one value, not"},           // CLI11 2.6
          {"1 required ", "value "}})
        text = replaced(text, old_text, new_text);
    return text;
}

/// Throws UserError for arguments that CLI11 would read in an unexpected way: it takes the value of "--quiet=x" as a
/// count, the next argument as the value of "--size=", and "-q=x" as -q and "-=x".
void check_arguments(const CLI::App& program, const std::vector<std::string>& arguments) {
    const CLI::App* command = &program;
    for (const std::string& argument : arguments) {
        const std::size_t equals = argument.find('=');
        for (const CLI::App* subcommand : command->get_subcommands({}))
            if (subcommand->get_name() == argument) command = subcommand;
        if (!argument.starts_with("-") || equals == std::string::npos) continue;
        const std::string option = argument.substr(0, equals);
        const CLI::Option* const named = command->get_option_no_throw(option);
        if (named != nullptr && named->get_items_expected_max() == 0)
            throw UserError(option + ": the option takes no value");
        if (named != nullptr && !option.starts_with("--"))
            throw UserError(option + ": write a blank before the value, not =");
        if (named != nullptr && equals + 1 == argument.size())
            refuse_value(option, "", "must not be empty", named->get_description());
    }
}

}  // namespace

std::vector<std::string> command_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::App* subcommand : command.get_subcommands({})) names.push_back(subcommand->get_name());
    return names;
}

void parse_arguments(CLI::App& program, const std::vector<std::string>& arguments) {
    try {
        check_arguments(program, arguments);
        program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) throw;  // --help or --version, not an error
        std::string path;
        const CLI::App& command = selected_command(program, path);
        throw UserError(fmt::format("{}{}{}; see raya{} --help", path.empty() ? "" : path.substr(1),
                                    path.empty() ? "" : ": ", failure_reason(program, command, error, arguments),
                                    path));
    }
}

}  // namespace raya
