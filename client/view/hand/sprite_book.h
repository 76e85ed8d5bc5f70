#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "client/view/hand/hand_sprite.h"

namespace tessera {

namespace proto {
class SpriteList;
}

/// The sprites around the view, kept up to date by everybody's edits. Asks for lists; who holds it asks the
/// server.
class SpriteBook {
  public:
    /// Of another scene, or of one whose history began anew: nothing is known.
    void begin(std::int32_t patterns, std::int32_t side_texels);
    /// What is known may be wrong: a list is asked for.
    void doubt() { is_sure_ = false; }

    void look_at(const TexelBox& view);
    /// The box to ask the server about; nothing while an answer is awaited, or none is needed.
    std::optional<TexelBox> take_question();
    void answer(const TexelBox& box, const proto::SpriteList& list);
    /// No answer came: asked again later.
    void no_answer() { is_asking_ = false; }

    /// An edit was made.
    void take(const std::vector<proto::Change>& changes, std::uint64_t revision,
              const std::vector<TexelBox>& dirty);

    const HandSprite* find(SpriteId id) const;
    /// In the order of drawing.
    std::vector<const HandSprite*> in_order() const;
    std::size_t size() const { return sprites_.size(); }
    /// There are more in the view than are known.
    bool is_partial() const { return partial_; }

    /// Whether a pattern has colour at a place, each 0 to 1 from the top left.
    using Covers = std::function<bool(const HandSprite& sprite, double u, double v)>;
    /// The uppermost sprite at a place; tiny ones can be taken hold of in a square of 2·`least_half` texels.
    const HandSprite* at(const HandPoint& place, double least_half, Step step, const Covers& covers) const;
    /// Those whose middle lies in a box.
    std::vector<SpriteId> within(const TexelBox& box, Step step) const;

  private:
    struct Edit {
        std::uint64_t revision = 0;
        std::vector<proto::Change> changes;
    };
    bool make(const std::vector<proto::Change>& changes);

    std::int32_t patterns_ = 0, side_texels_ = 1;
    std::map<SpriteId, HandSprite> sprites_;
    std::optional<TexelBox> box_;  ///< Of which all are known
    std::optional<TexelBox> view_;
    std::deque<Edit> edits_;  ///< The latest, to be made again on a list that is older
    bool partial_ = false, is_sure_ = false, is_asking_ = false;
};

}  // namespace tessera
