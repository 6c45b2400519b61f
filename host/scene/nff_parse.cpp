// Parsing of NFF: pieces of a long text are read on several threads, then joined in their order. A piece that depends
// on the text before it, or has an error, is read again by the reader of the whole text, which therefore finds every
// error where a reader without pieces finds it.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/nff_tokens.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
namespace {

/// Reads entities into a scene.
class NffReader {
  public:
    /// Starts before the first token of `text`, which must outlive this object. `remarks`: null in strict mode, in
    /// which every deviation is an error.
    NffReader(std::string_view text, const std::string& name, int first_line, std::vector<SceneRemark>* remarks);

    /// Skips to the first token at or after `position`, and takes its line as line 1.
    void start_at(std::size_t position) { tokens_.start_at(position); }

    /// Reads the entities that start before `end`, an index into the text. Throws UserError "NAME:LINE: reason".
    void read_until(std::size_t end);

    /// Adds what `piece` has read, and continues where it ended. `piece` must have started where this reader is, at an
    /// entity, and `piece_remarks` are its remarks. Changes nothing and returns false if reading the piece's entities
    /// with this reader could give another scene or an error.
    bool adopt(NffReader& piece, const std::vector<SceneRemark>& piece_remarks);

    /// Returns the scene, after the last entity. Throws UserError if it is incomplete.
    Scene finish();

    const NffTokens& tokens() const { return tokens_; }

  private:
    [[noreturn]] void refuse(std::string_view reason) const { tokens_.refuse(tokens_.entity_line(), reason); }
    void remark_or_refuse(std::string_view reason, const std::string& what);
    double read_length(std::string_view what) { return tokens_.take_number(what, kMaxSceneLength); }
    Vec3 read_vector(std::string_view what, double max = kMaxSceneLength);
    Colour read_colour(std::string_view what);
    double read_weight(std::string_view what);
    void read_entity();
    void read_view();
    template <std::size_t N>
    [[noreturn]] void refuse_incomplete_view(const std::array<std::string_view, N>& parts, const std::bitset<N>& seen);
    void read_background();
    void read_light();
    void read_surface();
    /// Returns the number of the surface in the scene, to which it is added unless it is equal to one of the last
    /// surfaces. Many files repeat a few surfaces millions of times.
    int number_of(const Surface& surface);
    int take_flat_surface();
    void read_sphere();
    void read_flat_polygon() { read_polygon(false); }
    void read_patch() { read_polygon(true); }
    void read_polygon(bool patch);
    void read_cone();
    void read_directive();
    void read_plane();
    void read_checker();

    NffTokens tokens_;
    std::vector<SceneRemark>* remarks_;
    Scene scene_;
    bool has_view_ = false, has_background_ = false;
    int current_surface_ = 0;
    bool has_copied_first_surface_ = false;  // for a checker; in a piece, the first surface stands for an unknown one
    std::optional<Checker> checker_;         // pending, for the next plane or polygon
    int checker_line_ = 0;
};

constexpr int kMaxResolution = 16384;  // pixels
// Maximum of Kd, Ks and T. Values above 1 are unphysical; values above 100 are probably typing errors.
constexpr double kMaxWeight = 100;
constexpr int kMaxVertices = 1'000'000'000;

NffReader::NffReader(std::string_view text, const std::string& name, int first_line, std::vector<SceneRemark>* remarks)
    : tokens_(text, name, first_line), remarks_(remarks) {
    scene_.name = std::filesystem::path(name).filename().string();
    scene_.surfaces.emplace_back();  // for objects before the first `f`
}

void NffReader::read_until(std::size_t end) {
    while (!tokens_.peek().text.empty() && tokens_.next_at() < end) read_entity();
}

Scene NffReader::finish() {
    const int end = tokens_.peek().line;
    if (checker_) tokens_.refuse(checker_line_, "no plane or polygon follows this '#raya checker'");
    if (!has_view_) tokens_.refuse(end, "no 'v': the file has no viewpoint");
    if (scene_.object_count() == 0) tokens_.refuse(end, "no object: the image would be empty");
    merge_equal_surfaces(scene_);
    return std::move(scene_);
}

/// Reports an object that cannot be traced as given. In strict mode throws UserError with `reason`. Otherwise adds
/// the remark `what`; the caller then leaves the object out or repairs it.
void NffReader::remark_or_refuse(std::string_view reason, const std::string& what) {
    if (!remarks_) refuse(reason);
    add_remark(*remarks_, {.what = what, .line = tokens_.entity_line()});
}

Vec3 NffReader::read_vector(std::string_view what, double max) {
    Vec3 vector;
    for (int axis = 0; axis < 3; ++axis) vector[axis] = tokens_.take_number(what, max);
    return vector;
}

Colour NffReader::read_colour(std::string_view what) {
    const Colour colour = read_vector(what, kMaxNumber);
    if (!is_colour(colour)) refuse(fmt::format("{} is negative", what));
    return colour;
}

double NffReader::read_weight(std::string_view what) {
    const double weight = tokens_.take_number(what);
    if (weight < 0 || weight > kMaxWeight) refuse(fmt::format("{} is {}: must be 0..{}", what, weight, kMaxWeight));
    return weight;
}

void NffReader::read_entity() {
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
    if (is_number) refuse(in_quotes(keyword) + " instead of an entity: does the previous one have too many numbers?");
    if (remarks_ && tokens_.skip_unknown())
        return add_remark(*remarks_, {.what = "entity " + in_quotes(keyword) + " of another dialect, skipped",
                                      .line = tokens_.entity_line()});
    refuse("unknown entity " + in_quotes(keyword) + "; NFF has v b l f s p pp c");
}

void NffReader::read_view() {
    static constexpr std::array<std::string_view, 6> kParts{"from", "at", "up", "angle", "hither", "resolution"};
    if (has_view_) refuse("a second 'v': a scene has one viewpoint");
    View& view = scene_.view;
    std::bitset<kParts.size()> seen;
    while (!seen.all()) {
        const auto part = std::find(kParts.begin(), kParts.end(), tokens_.peek().text);
        const auto index = static_cast<std::size_t>(part - kParts.begin());
        if (part == kParts.end()) refuse_incomplete_view(kParts, seen);
        if (seen[index]) tokens_.refuse(tokens_.peek().line, fmt::format("'{}' occurs twice in 'v'", *part));
        seen.set(index);
        tokens_.take_name(*part);
        if (*part == "from") view.from = read_vector("from");
        if (*part == "at") view.at = read_vector("at");
        if (*part == "up") view.up = read_vector("up");
        if (*part == "angle") view.angle_degrees = tokens_.take_number("angle");
        if (*part == "hither") view.hither = read_length("hither");
        if (*part == "resolution") {
            view.width = tokens_.take_integer("the width", 1, kMaxResolution);
            view.height = tokens_.take_integer("the height", 1, kMaxResolution);
        }
    }
    if (const std::string reason = view_error(view); !reason.empty()) refuse(reason);
    has_view_ = true;
}

template <std::size_t N>
void NffReader::refuse_incomplete_view(const std::array<std::string_view, N>& parts, const std::bitset<N>& seen) {
    std::string missing;
    for (std::size_t i = 0; i < N; ++i)
        if (!seen[i]) missing += fmt::format(" {}", parts[i]);
    const NffToken& token = tokens_.peek();
    const std::string found = token.text.empty() ? "the file ends" : in_quotes(token.text) + " follows";
    tokens_.refuse(token.line, fmt::format("'v' is incomplete: {}; missing parts:{}", found, missing));
}

void NffReader::read_background() {
    if (has_background_) refuse("a second 'b': a scene has one background");
    scene_.background = read_colour("the background colour");
    has_background_ = true;
}

void NffReader::read_light() {
    Light light{read_vector("the position"), {}};
    if (tokens_.number_follows()) light.colour = read_colour("the light's colour");
    scene_.lights.push_back(light);
}

void NffReader::read_surface() {
    Surface surface;
    surface.colour = read_colour("the colour");
    surface.diffuse = read_weight("Kd");
    surface.specular = read_weight("Ks");
    surface.shine = tokens_.take_number("Shine");
    surface.transmittance = read_weight("T");
    surface.refraction_index = tokens_.take_number("the index of refraction");
    if (surface.shine < 0) refuse(fmt::format("Shine is {}: must not be negative", surface.shine));
    if (surface.transmittance > 0 && surface.refraction_index <= 0)
        refuse(fmt::format("the index of refraction is {}: must be positive where T > 0", surface.refraction_index));
    current_surface_ = number_of(surface);
}

int NffReader::number_of(const Surface& surface) {
    constexpr std::ptrdiff_t kCompared = 64;
    // The first surface is not compared: in a piece it stands for an unknown one.
    const auto first = scene_.surfaces.begin() + 1, end = scene_.surfaces.end();
    const auto equal = std::find(end - std::min(kCompared, end - first), end, surface);
    const auto number = static_cast<int>(equal - scene_.surfaces.begin());
    if (equal == end) scene_.surfaces.push_back(surface);
    return number;
}

/// Returns the surface of a plane or polygon: the current surface, with the pending checker if there is one.
int NffReader::take_flat_surface() {
    if (!checker_) return current_surface_;
    has_copied_first_surface_ |= current_surface_ == 0;
    Surface surface = scene_.surfaces[static_cast<std::size_t>(current_surface_)];
    surface.checker = std::exchange(checker_, std::nullopt);
    return number_of(surface);
}

void NffReader::read_sphere() {
    Sphere sphere{read_vector("the centre"), 0, current_surface_};
    sphere.radius = read_length("the radius");
    if (std::abs(sphere.radius) < kMinSceneLength)
        return remark_or_refuse("the radius of the sphere is zero", "sphere of radius 0, left out");
    scene_.spheres.push_back(sphere);
}

void NffReader::read_polygon(bool patch) {
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
    if (std::find(polygon.normals.begin(), polygon.normals.end(), Vec3(0)) != polygon.normals.end()) {
        remark_or_refuse("a normal of the patch is zero", "patch with a normal of 0, taken as a flat polygon");
        polygon.normals.clear();
    }
    add_polygon(scene_, std::move(polygon),
                [&](const std::string& reason, const std::string& what) { remark_or_refuse(reason, what); });
}

void NffReader::read_cone() {
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

void NffReader::read_directive() {
    const std::string_view name = tokens_.take_name("'plane' or 'checker'");
    if (name == "plane") return read_plane();
    if (name == "checker") return read_checker();
    refuse("unknown extension " + in_quotes(name) + "; raya knows '#raya plane' and '#raya checker'");
}

void NffReader::read_plane() {
    const Vec3 file_normal = read_vector("the normal");
    Plane plane{unit_vector(file_normal), read_length("the distance"), 0};
    if (plane.normal == Vec3(0)) refuse("the normal of the plane is zero");
    if (plane.normal != file_normal) plane.distance /= file_normal.length();
    if (!(std::abs(plane.distance) <= kMaxSceneLength))
        refuse("the plane is too far from the origin: at most 1e30 with a normal of length 1");
    plane.surface = take_flat_surface();
    scene_.planes.push_back(plane);
}

void NffReader::read_checker() {
    if (checker_) refuse("a second '#raya checker' before a plane or polygon has used the first");
    Checker checker{read_colour("the first colour"), read_colour("the second colour"), 0};
    checker.size = read_length("the size");
    if (checker.size < kMinSceneLength) refuse("the size of the checker must be positive");
    checker_ = checker;
    checker_line_ = tokens_.entity_line();
}

struct Piece {
    std::size_t begin, end;              // its entities start at begin .. end - 1
    std::optional<NffReader> reader;     // after the piece; empty if the piece has an error
    std::vector<SceneRemark> remarks{};  // of the reader; their lines count from the start of the piece
};

/// Returns the index of the first line at or after `from` that may start with an entity of an object, or the length of
/// the text if there is none.
std::size_t object_line(std::string_view text, std::size_t from) {
    constexpr std::string_view kObjects = "spc";
    while ((from = text.find_first_of("\r\n", from)) < text.size())
        if (++from < text.size() && kObjects.find(text[from]) != kObjects.npos) return from;
    return text.size();
}

/// Returns the next pieces, from `from` to the end of the text, but at most `max_pieces`.
std::vector<Piece> next_pieces(std::string_view text, std::size_t from, std::size_t bytes, std::size_t max_pieces) {
    std::vector<Piece> pieces;
    while (pieces.size() < max_pieces && from < text.size()) {
        const std::size_t end = object_line(text, from + std::min(bytes, text.size() - from));
        pieces.push_back({from, end, {}});
        from = end;
    }
    return pieces;
}

/// Moves the objects of a piece to the end of `objects`. `surface_of(i)`: new number of the piece's surface i.
/// `pieces`: expected size of the whole text, in sizes of the text read so far.
template <class Object, class SurfaceOf>
void append_objects(std::vector<Object>& objects, std::vector<Object>& added, const SurfaceOf& surface_of,
                    double pieces) {
    for (Object& object : added) object.surface = surface_of(object.surface);
    const std::size_t size = objects.size() + added.size();
    // Doubling the capacity at the end of a large scene would take much more memory than it needs.
    if (size > objects.capacity())
        objects.reserve(static_cast<std::size_t>(static_cast<double>(size) * std::max(pieces, 1.125)));
    std::move(added.begin(), added.end(), std::back_inserter(objects));
}

void read_piece(Piece& piece, std::string_view text, const std::string& name, bool lenient) {
    try {
        piece.reader.emplace(text, name, 1, lenient ? &piece.remarks : nullptr);
        piece.reader->start_at(piece.begin);
        piece.reader->read_until(piece.end);
    } catch (const UserError&) {
        piece.reader.reset();
    }
}

}  // namespace

bool NffReader::adopt(NffReader& piece, const std::vector<SceneRemark>& piece_remarks) {
    if (checker_ || piece.has_copied_first_surface_ || (has_view_ && piece.has_view_) ||
        (has_background_ && piece.has_background_))
        return false;
    for (const SceneRemark& remark : piece_remarks)
        add_remark(*remarks_, {remark.what, remark.count, remark.line + tokens_.peek().line - 1});
    if (piece.checker_) {
        checker_ = piece.checker_;
        checker_line_ = piece.checker_line_ + tokens_.peek().line - 1;
    }
    if (piece.has_view_) scene_.view = piece.scene_.view;
    if (piece.has_background_) scene_.background = piece.scene_.background;
    has_view_ |= piece.has_view_;
    has_background_ |= piece.has_background_;
    Scene& added = piece.scene_;
    std::vector<int> numbers = {current_surface_};  // of the piece's surfaces; its first stands for the current one
    for (std::size_t i = 1; i < added.surfaces.size(); ++i) numbers.push_back(number_of(added.surfaces[i]));
    const auto surface_of = [&](int surface) { return numbers[static_cast<std::size_t>(surface)]; };
    current_surface_ = surface_of(piece.current_surface_);
    tokens_.continue_after(piece.tokens_);
    scene_.lights.insert(scene_.lights.end(), added.lights.begin(), added.lights.end());
    const double pieces = static_cast<double>(tokens_.text().size()) / static_cast<double>(tokens_.next_at());
#define RAYA_APPEND(kind, kinds, KIND) append_objects(scene_.kinds, added.kinds, surface_of, pieces);
    RAYA_OBJECT_LIST(RAYA_APPEND)
    return true;
}

Scene parse_nff(std::string_view text, const std::string& name, std::vector<SceneRemark>* remarks,
                const NffPieces& division) {
    const MailHeader header = remarks ? mail_header(text) : MailHeader{};
    if (header.bytes > 0) add_remark(*remarks, {.what = "mail header before the scene, skipped", .line = 1});
    NffReader reader(text.substr(header.bytes), name, 1 + header.lines, remarks);
    const NffTokens& tokens = reader.tokens();
    if (is_sense8_keyword(tokens.peek().text))
        tokens.refuse(tokens.peek().line,
                      "this is Sense8's NFF (WorldToolKit), another format of the same name; raya reads E. Haines's "
                      "NFF");
    const std::size_t size = tokens.text().size();
    reader.read_until(size > division.bytes ? object_line(tokens.text(), 0) : size);
    while (!tokens.peek().text.empty()) {
        std::vector<Piece> pieces = next_pieces(tokens.text(), tokens.next_at(), division.bytes, 4 * division.threads);
        parallel_for(pieces.size(), division.threads,
                     [&](std::size_t i) { read_piece(pieces[i], tokens.text(), name, remarks); });
        for (Piece& piece : pieces) {
            const bool adopted = piece.reader && tokens.next_at() == piece.begin && tokens.peek().first_on_line &&
                                 reader.adopt(*piece.reader, piece.remarks);
            if (!adopted) reader.read_until(piece.end);
            piece.reader.reset();
        }
    }
    return reader.finish();
}

}  // namespace raya
