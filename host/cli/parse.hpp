// Parsers of the command line, with error messages of one line, and of structured option values.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/cli/options.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// Parses integers from 1 to 10^6 with separators: {512, 256} for "512x256". Returns an empty vector for other texts.
std::vector<std::uint32_t> parse_sizes(const std::string& text, char separator = 'x');

/// Parses an image size: "512" (square) or "512x256". Throws UserError with the legal values. image_size()
/// checks that no side exceeds kMaxSide.
ImageSize parse_image_size(const std::string& text);

/// Parses three numbers, along x, y and z: "4x4x4". Throws UserError with `option` and `legal_values`, such as
/// "1..256 each".
std::array<std::uint32_t, 3> parse_three_sides(const std::string& option, const std::string& text,
                                               const std::string& legal_values);

/// Parses --accel: "none", "bvh", "grid" or "grid:AxBxC". Throws UserError with the option and its legal values.
Accel parse_accel(const std::string& text);

/// Parses a comma-separated list of formats, each as in --format.
std::vector<NumberFormat> parse_formats(const std::string& list);

// The choices of options that are enumerations.
inline const Choices<AntialiasMethod> kAntialiasChoices = {{"none", AntialiasMethod::kNone},
                                                           {"filter", AntialiasMethod::kFilter},
                                                           {"supersample", AntialiasMethod::kSupersample}};
inline const Choices<Fold> kFoldChoices = {{"cyclic", Fold::kCyclic}, {"block", Fold::kBlock}};

/// Adds --device, a selector for choose_device().
void add_device_option(CLI::App& command, std::string& device);

// Parsers of --mapping and --fold.

/// A static mapping of pixels to PEs, as given on the command line:
///
///     cyclic, cyclic:p   the cyclic mapping with offset p; "cyclic" alone: p from --offset or the machine
///     column             the cyclic mapping with offset 0: whole columns, Kohata & Ito's column split
///     rows               scan lines round robin
///     blocks             contiguous blocks of scan lines
///     grid:AxB           A rows of B PEs; each PE has every B-th pixel of every A-th line
///     tiles:WxH          tiles of W x H pixels round robin; W and H divide the image's sides
///     random:seed        random pixels, the same number for each PE; "random" alone: seed 1
struct MappingText {
    std::string text;                 // as given on the command line
    MappingRule rule{};               // has the cyclic fold; ring_settings() applies --fold
    bool takes_offset_option = true;  // true for "cyclic" without p: --offset sets p

    /// Returns the part of `text` before the colon.
    std::string name() const { return text.substr(0, text.find(':')); }
};

/// Parses a static mapping. Throws UserError with the option and its legal forms.
MappingText parse_mapping(const std::string& text);

/// Returns true if the text names a dynamic or hybrid mapping, which parse_dynamic() parses.
bool is_dynamic(const std::string& text);

/// Parses "dynamic:chunk[,overhead[,root]]" or "hybrid:chunk[,overhead[,share[,root]]]". `chunk`: pixels per request;
/// `overhead`: cycles of the PE per request; `root`: cycles of the root per request; `share`: fraction of a PE's pixels
/// that is assigned statically, default 0.5 for hybrid. `defaults` supplies the other missing numbers. Throws UserError
/// with the option and its legal forms.
DynamicPlan parse_dynamic(const std::string& text, const DynamicPlan& defaults = {});

// Options that replace the scene's camera, background and lights.

/// The options as given on the command line. An empty value means the scene's value.
struct ViewOptions {
    std::string from{}, at{}, up{}, background{};
    std::optional<double> angle{};  // degrees
    std::vector<std::string> lights{};

    bool given() const { return !given_options().empty(); }

    /// Returns the options that were given, with their values: {"--from", "1,2,3"}.
    std::vector<std::pair<std::string, std::string>> given_options() const;
};

/// Adds --from, --at, --up, --angle, --background and --light.
void add_view_options(CLI::App& command, ViewOptions& options);

/// Applies all options to the scene, with the range checks of the NFF reader. Throws UserError with the option's name.
void change_view(const ViewOptions& options, Scene& scene);

/// Parses the arguments (without the program's name) and runs the command. Throws UserError with a message of one line
/// for a bad argument. Throws CLI::ParseError, with exit code 0, for --help and --version.
void parse_arguments(CLI::App& program, const std::vector<std::string>& arguments);

/// Returns the names of a command's subcommands.
std::vector<std::string> command_names(const CLI::App& command);

}  // namespace raya
