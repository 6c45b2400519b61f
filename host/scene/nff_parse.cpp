// Parsing of NFF: tokens, dialects, entities.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
namespace {

constexpr std::string_view kDirective = "#raya";

enum class CharKind : std::uint8_t { kText, kBlank, kLineEnd, kHash, kBinary };

CharKind kind_of(char c) {
    const auto code = static_cast<unsigned char>(c);
    if (code > ' ' && c != '#' && code != 0x7f) return CharKind::kText;
    if (c == '#') return CharKind::kHash;
    if (c == '\r' || c == '\n') return CharKind::kLineEnd;
    return c == ' ' || c == '\t' || c == '\v' || c == '\f' ? CharKind::kBlank : CharKind::kBinary;
}

bool is_blank(char c) { return kind_of(c) == CharKind::kBlank || kind_of(c) == CharKind::kLineEnd; }

struct ParsedNumber {
    double value = 0;
    std::string_view rest;  // remaining characters after the number
    std::errc error{};
};

/// Parses the number at the start of a text with std::from_chars, which ignores the locale. Removes a leading '+'
/// first, because std::from_chars rejects it, while scanf and therefore other NFF readers accept it.
ParsedNumber parsed_number(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    ParsedNumber number;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number.value);
    number.rest = text.substr(static_cast<std::size_t>(end - text.data()));
    number.error = error;
    return number;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// Returns true if a token may be the keyword of an NFF dialect (`la`, `tt`, `Q`): at most eight letters, digits and
/// underscores.
bool reads_as_keyword(std::string_view token) {
    constexpr std::size_t kMaxLength = 8;
    return !token.empty() && token.size() <= kMaxLength && is_letter(token[0]) &&
           std::ranges::all_of(token, [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

/// A run of characters without white space. At the end of the file `text` is empty.
struct NffToken {
    std::string_view text;
    int line = 1;
    bool first_on_line = false;
};

/// Splits a text into tokens. Skips comments (`#` to the end of the line) except `#raya` at the start of a line. Lines
/// may end in LF, CR LF or CR. Every error is a UserError "NAME:LINE: reason".
class NffTokens {
  public:
    /// `text` must outlive this object. Control characters, as in a binary file, are an error.
    NffTokens(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // which some editors write at the start of a file
        if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
        advance();
    }

    /// Returns the next token without taking it.
    const NffToken& peek() const { return next_; }

    /// Takes the keyword of the next entity. The keyword must be the first token of a line. An entity that starts with
    /// `#raya` must end on the same line.
    std::string_view take_keyword() {
        const NffToken keyword = next_;
        if (!keyword.first_on_line)
            refuse(keyword.line, fmt::format("{} follows the end of {}; a new entity starts on a new line",
                                             in_quotes(keyword.text), in_quotes(entity_)));
        entity_ = keyword.text;
        entity_line_ = keyword.line;
        one_line_ = keyword.text == kDirective;
        advance();
        return keyword.text;
    }

    /// Takes the name after `#raya`, or a label inside the viewpoint entity `v`, such as `from`; `what` describes it in
    /// messages.
    std::string_view take_name(std::string_view what) {
        const NffToken token = take_part(what);
        if (one_line_) entity_ += fmt::format(" {}", token.text);
        return token.text;
    }

    /// Takes a finite number of at most `max` in magnitude; `what` describes it in messages ("the radius").
    double take_number(std::string_view what, double max = kMaxNumber) {
        const ParsedNumber number = parsed_number(next_.text);
        const bool is_not_number = number.error == std::errc::invalid_argument;
        const bool incomplete = is_not_number && next_.first_on_line && !one_line_;
        const NffToken token = take_part(what);
        const auto refuse_token = [&](std::string_view reason) {
            refuse(token.line, fmt::format("{} of {}: {} {}", what, in_quotes(entity_), in_quotes(token.text), reason));
        };
        if (incomplete)
            refuse(token.line, fmt::format("{} of line {} is incomplete: expected {}, found {}", in_quotes(entity_),
                                           entity_line_, what, in_quotes(token.text)));
        if (is_not_number) refuse_token("is not a number");
        if (number.error == std::errc::result_out_of_range) refuse_token("is outside the range of double precision");
        if (!number.rest.empty()) refuse_token("has characters after the number");
        if (!std::isfinite(number.value)) refuse_token("is not a finite number");
        if (std::abs(number.value) > max)
            refuse_token(fmt::format("is out of range: at most {:.0e} in magnitude", max));
        return number.value;
    }

    /// Takes an integer in [lowest, highest]; `what` describes it in messages.
    int take_integer(std::string_view what, int lowest, int highest) {
        const int line = next_.line;
        const double value = take_number(what, std::numeric_limits<double>::infinity());
        if (value != std::floor(value) || value < lowest || value > highest)
            refuse(line, fmt::format("{} of {} is {}: must be a whole number from {} to {}", what, in_quotes(entity_),
                                     value, lowest, highest));
        return static_cast<int>(value);
    }

    /// Skips the rest of an entity's line and all following lines that begin with a number.
    void skip_entity() {
        while (!next_.text.empty() && (!next_.first_on_line || number_follows())) advance();
    }

    /// Returns true if the next token starts with a number; more characters may follow it.
    bool number_follows() const { return parsed_number(next_.text).error != std::errc::invalid_argument; }

    int entity_line() const { return entity_line_; }  // line on which the current entity started

    /// Returns the number of characters after the next token.
    std::size_t characters_left() const { return text_.size() - position_; }

    /// Throws UserError "NAME:LINE: reason".
    [[noreturn]] void refuse(int line, std::string_view reason) const {
        throw UserError(fmt::format("{}:{}: {}", name_, line, reason));
    }

  private:
    [[noreturn]] void refuse_binary() const {
        refuse(line_, "a control character: is this a binary file? NFF is plain text");
    }

    bool is_at_directive() const {
        const std::string_view rest = text_.substr(position_);
        return rest.starts_with(kDirective) && (rest.size() == kDirective.size() || is_blank(rest[kDirective.size()]));
    }

    void skip_blanks_and_comments() {
        for (bool comment = false; position_ < text_.size(); ++position_) {
            const CharKind kind = kind_of(text_[position_]);
            if (kind == CharKind::kBinary) refuse_binary();
            if (kind == CharKind::kLineEnd) {
                line_ += text_.substr(position_).starts_with("\r\n") ? 0 : 1;
                at_line_start_ = true;
                comment = false;
            } else if (kind != CharKind::kBlank && !comment) {
                if (kind == CharKind::kText || (at_line_start_ && is_at_directive())) return;
                if (is_at_directive()) refuse(line_, "'#raya' must be the first word of its line");
                comment = true;
            }
        }
    }

    void advance() {
        skip_blanks_and_comments();
        const std::size_t start = position_;
        if (position_ < text_.size()) ++position_;
        while (position_ < text_.size() && kind_of(text_[position_]) == CharKind::kText) ++position_;
        if (position_ < text_.size() && kind_of(text_[position_]) == CharKind::kBinary) refuse_binary();
        next_ = {text_.substr(start, position_ - start), line_, at_line_start_};
        at_line_start_ = false;
    }

    NffToken take_part(std::string_view what) {
        const NffToken token = next_;
        if (token.text.empty())
            refuse(token.line, fmt::format("the file ends before {} of {}", what, in_quotes(entity_)));
        if (one_line_ && token.line != entity_line_)
            refuse(entity_line_, fmt::format("the line ends before {} of {}", what, in_quotes(entity_)));
        advance();
        return token;
    }

    std::string_view text_;
    std::string name_;
    std::size_t position_ = 0;  // index of the first character after next_
    int line_ = 1;
    bool at_line_start_ = true;
    NffToken next_;
    std::string entity_;  // the current entity's name in messages
    int entity_line_ = 1;
    bool one_line_ = false;  // true if the current entity must end on the line on which it starts
};

constexpr int kMaxResolution = 16384;  // pixels
constexpr int kMaxVertices = 1'000'000'000;

/// Reads entities into a scene.
class NffReader {
  public:
    /// Starts before the first token of `text`, which must outlive this object. `remarks`: null in strict mode, in
    /// which every deviation is an error.
    NffReader(std::string_view text, const std::string& name, std::vector<SceneRemark>* remarks)
        : tokens_(text, name), remarks_(remarks) {
        scene_.name = std::filesystem::path(name).filename().string();
        scene_.surfaces.emplace_back();  // for objects before the first `f`
    }

    /// Reads all entities and returns the scene. Throws UserError "NAME:LINE: reason".
    Scene read() {
        while (!tokens_.peek().text.empty()) read_entity();
        const int end = tokens_.peek().line;
        if (checker_) tokens_.refuse(checker_line_, "no plane or polygon follows this '#raya checker'");
        if (!has_view_) tokens_.refuse(end, "no 'v': the file has no viewpoint");
        if (scene_.object_count() == 0) tokens_.refuse(end, "no object: the image would be empty");
        merge_equal_surfaces(scene_);
        return std::move(scene_);
    }

  private:
    [[noreturn]] void refuse(std::string_view reason) const { tokens_.refuse(tokens_.entity_line(), reason); }

    /// Reports an object that cannot be traced as given. In strict mode throws UserError with `reason`. Otherwise adds
    /// the remark `what`; the caller then leaves the object out or repairs it.
    void remark_or_refuse(std::string_view reason, const std::string& what) {
        if (!remarks_) refuse(reason);
        add_remark(*remarks_, {.what = what, .line = tokens_.entity_line()});
    }

    double read_length(std::string_view what) { return tokens_.take_number(what, kMaxSceneLength); }

    Vec3 read_vector(std::string_view what, double max = kMaxSceneLength) {
        Vec3 vector;
        for (int axis = 0; axis < 3; ++axis) vector[axis] = tokens_.take_number(what, max);
        return vector;
    }

    Colour read_colour(std::string_view what) {
        const Colour colour = read_vector(what, kMaxNumber);
        if (!is_colour(colour)) refuse(fmt::format("{} is negative", what));
        return colour;
    }

    double read_weight(std::string_view what) {
        const double weight = tokens_.take_number(what);
        if (weight < 0 || weight > kMaxWeight) refuse(fmt::format("{} is {}: must be 0..{}", what, weight, kMaxWeight));
        return weight;
    }

    void read_entity() {
        struct Entity {
            std::string_view keyword;
            void (NffReader::*read)();
        };
        static constexpr Entity kEntities[] = {
            {"v", &NffReader::read_view},    {"b", &NffReader::read_background}, {"l", &NffReader::read_light},
            {"f", &NffReader::read_surface}, {"s", &NffReader::read_sphere},     {"p", &NffReader::read_flat_polygon},
            {"pp", &NffReader::read_patch},  {"c", &NffReader::read_cone},       {"#raya", &NffReader::read_directive}};
        const bool is_number = tokens_.number_follows();
        const std::string_view keyword = tokens_.take_keyword();
        for (const Entity& entity : kEntities)
            if (entity.keyword == keyword) return (this->*entity.read)();
        if (is_number)
            refuse(in_quotes(keyword) + " instead of an entity: does the previous one have too many numbers?");
        if (remarks_ && reads_as_keyword(keyword)) {
            tokens_.skip_entity();
            return add_remark(*remarks_, {.what = "entity " + in_quotes(keyword) + " of another dialect, skipped",
                                          .line = tokens_.entity_line()});
        }
        refuse("unknown entity " + in_quotes(keyword) +
               "; NFF has v b l f s p pp c; the names of meshes end in .obj, .ply, .gltf, .glb or .stl");
    }

    void read_view() {
        if (has_view_) refuse("a second 'v': a scene has one viewpoint");
        View& view = scene_.view;
        std::vector<std::string_view> missing(kParts.begin(), kParts.end());
        while (!missing.empty()) {
            const std::string_view part = tokens_.peek().text;
            if (std::erase(missing, part) == 0) refuse_view(missing);
            tokens_.take_name(part);
            if (part == "from") view.from = read_vector("from");
            if (part == "at") view.at = read_vector("at");
            if (part == "up") view.up = read_vector("up");
            if (part == "angle") view.angle_degrees = tokens_.take_number("angle");
            if (part == "hither") view.hither = read_length("hither");
            if (part == "resolution") {
                view.width = tokens_.take_integer("the width", 1, kMaxResolution);
                view.height = tokens_.take_integer("the height", 1, kMaxResolution);
            }
        }
        if (const std::string reason = view_error(view); !reason.empty()) refuse(reason);
        has_view_ = true;
    }

    /// Refuses the next token, which is none of the missing parts of the view.
    [[noreturn]] void refuse_view(const std::vector<std::string_view>& missing) {
        const auto [text, line, first_on_line] = tokens_.peek();
        if (std::ranges::find(kParts, text) != kParts.end())
            tokens_.refuse(line, fmt::format("'{}' occurs twice in 'v'", text));
        const std::string found = text.empty() ? "the file ends" : in_quotes(text) + " follows";
        tokens_.refuse(line, fmt::format("'v' is incomplete: {}; missing parts: {}", found, fmt::join(missing, " ")));
    }

    void read_background() {
        if (has_background_) refuse("a second 'b': a scene has one background");
        scene_.background = read_colour("the background colour");
        has_background_ = true;
    }

    void read_light() {
        Light light{read_vector("the position"), {}};
        if (tokens_.number_follows()) light.colour = read_colour("the light's colour");
        scene_.lights.push_back(light);
    }

    void read_surface() {
        Surface surface;
        surface.colour = read_colour("the colour");
        surface.diffuse = read_weight("Kd");
        surface.specular = read_weight("Ks");
        surface.shine = tokens_.take_number("Shine");
        surface.transmittance = read_weight("T");
        surface.refraction_index = tokens_.take_number("the index of refraction");
        if (surface.shine < 0) refuse(fmt::format("Shine is {}: must not be negative", surface.shine));
        if (surface.transmittance > 0 && surface.refraction_index <= 0)
            refuse(
                fmt::format("the index of refraction is {}: must be positive where T > 0", surface.refraction_index));
        current_surface_ = number_of(surface);
    }

    /// Returns the number of the surface in the scene, to which it is added unless it is equal to one of the last
    /// surfaces. Many files repeat a few surfaces millions of times.
    int number_of(const Surface& surface) {
        constexpr std::ptrdiff_t kCompared = 64;
        const auto begin = scene_.surfaces.begin(), end = scene_.surfaces.end();
        const auto equal = std::find(end - std::min(kCompared, end - begin), end, surface);
        const auto number = static_cast<int>(equal - begin);
        if (equal == end) scene_.surfaces.push_back(surface);
        return number;
    }

    /// Returns the surface of a plane or polygon: the current surface, with the pending checker if there is one.
    int take_flat_surface() {
        if (!checker_) return current_surface_;
        Surface surface = scene_.surfaces[static_cast<std::size_t>(current_surface_)];
        surface.checker = std::exchange(checker_, std::nullopt);
        return number_of(surface);
    }

    void read_sphere() {
        Sphere sphere{read_vector("the centre"), 0, current_surface_};
        sphere.radius = read_length("the radius");
        if (std::abs(sphere.radius) < kMinSceneLength)
            return remark_or_refuse("the radius of the sphere is zero", "sphere of radius 0, left out");
        scene_.spheres.push_back(sphere);
    }

    void read_flat_polygon() { read_polygon(false); }
    void read_patch() { read_polygon(true); }

    void read_polygon(bool patch) {
        Polygon polygon;
        const int min_count = remarks_ ? 0 : 3;
        const auto count =
            static_cast<std::size_t>(tokens_.take_integer("the number of vertices", min_count, kMaxVertices));
        const std::size_t min_characters = patch ? 12 : 6;  // per vertex: a digit and a blank for each number
        if (count > tokens_.characters_left() / min_characters + 2)
            refuse(fmt::format("the file is too short for a polygon of {} vertices", count));
        polygon.vertices.reserve(count);
        polygon.normals.reserve(patch ? count : 0);
        for (std::size_t i = 0; i < count; ++i) {
            polygon.vertices.push_back(read_vector("a vertex"));
            if (!patch) continue;
            polygon.normals.push_back(unit_vector(read_vector("a normal")));
        }
        polygon.surface = take_flat_surface();
        if (std::ranges::count(polygon.normals, Vec3(0)) > 0) {
            remark_or_refuse("a normal of the patch is zero", "patch with a normal of 0, taken as a flat polygon");
            polygon.normals.clear();
        }
        add_polygon(scene_, std::move(polygon),
                    [&](const std::string& reason, const std::string& what) { remark_or_refuse(reason, what); });
    }

    void read_cone() {
        Cone cone;
        cone.base = read_vector("the base");
        cone.base_radius = read_length("the base radius");
        cone.apex = read_vector("the apex");
        cone.apex_radius = read_length("the apex radius");
        cone.surface = current_surface_;
        const auto [lower, upper] = std::minmax(cone.base_radius, cone.apex_radius);
        if (std::max(-lower, upper) < kMinSceneLength)
            return remark_or_refuse("both radii of the cone are zero", "cone without radius, left out");
        if (lower < 0 && upper > 0) refuse("one radius of the cone is negative, the other positive");
        if ((cone.apex - cone.base).length() < kMinSceneLength)
            return remark_or_refuse("the height of the cone is zero", "cone without height, left out");
        scene_.cones.push_back(cone);
    }

    void read_directive() {
        const std::string_view name = tokens_.take_name("'plane' or 'checker'");
        if (name == "plane") return read_plane();
        if (name == "checker") return read_checker();
        refuse("unknown extension " + in_quotes(name) + "; raya knows '#raya plane' and '#raya checker'");
    }

    void read_plane() {
        const Vec3 file_normal = read_vector("the normal");
        Plane plane{unit_vector(file_normal), read_length("the distance"), 0};
        if (plane.normal == Vec3(0)) refuse("the normal of the plane is zero");
        if (plane.normal != file_normal) plane.distance /= file_normal.length();
        if (!(std::abs(plane.distance) <= kMaxSceneLength))
            refuse("the plane is too far from the origin: at most 1e30 with a normal of length 1");
        plane.surface = take_flat_surface();
        scene_.planes.push_back(plane);
    }

    void read_checker() {
        if (checker_) refuse("a second '#raya checker' before a plane or polygon has used the first");
        Checker checker{read_colour("the first colour"), read_colour("the second colour"), 0};
        checker.size = read_length("the size");
        if (checker.size < kMinSceneLength) refuse("the size of the checker must be positive");
        checker_ = checker;
        checker_line_ = tokens_.entity_line();
    }

    static constexpr std::array<std::string_view, 6> kParts{"from", "at", "up", "angle", "hither", "resolution"};

    NffTokens tokens_;
    std::vector<SceneRemark>* remarks_;
    Scene scene_;
    bool has_view_ = false, has_background_ = false;
    int current_surface_ = 0;
    std::optional<Checker> checker_;  // pending, for the next plane or polygon
    int checker_line_ = 0;
};

}  // namespace

std::string in_quotes(std::string_view text) {
    constexpr std::size_t kShown = 24;
    std::string shown = "'";
    for (const char c : text.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown + (text.size() > kShown ? "...'" : "'");
}

Scene parse_nff(std::string_view text, const std::string& name, std::vector<SceneRemark>* remarks) {
    return NffReader(text, name, remarks).read();
}

}  // namespace raya
