// Parsing of NFF: pieces of a long text are read on several threads, then joined in their order. A piece that depends
// on the text before it, or has an error, is read again by the reader of the whole text, which therefore finds every
// error where a reader without pieces finds it.
#include <algorithm>
#include <iterator>
#include <optional>

#include "host/error.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/nff_dialects.hpp"
#include "host/scene/nff_reader.hpp"

namespace raya {
namespace {

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
    append_objects(scene_.spheres, added.spheres, surface_of, pieces);
    append_objects(scene_.planes, added.planes, surface_of, pieces);
    append_objects(scene_.polygons, added.polygons, surface_of, pieces);
    append_objects(scene_.cones, added.cones, surface_of, pieces);
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
