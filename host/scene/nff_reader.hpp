// The reader of NFF entities. Several readers may read pieces of one text on several threads (parse_nff()).
#pragma once
#include <array>
#include <bitset>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/scene/nff.hpp"
#include "host/scene/nff_tokens.hpp"

namespace raya {

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

}  // namespace raya
