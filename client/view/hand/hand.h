#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "client/view/hand/carries.h"
#include "client/view/hand/hand_edits.h"
#include "client/view/hand/selection_frame.h"
#include "client/view/hand/sprite_book.h"

namespace tessera {

/// What a hand works on, and what of it is seen: told once a frame.
struct HandView {
    ClientTime now{};
    Step step = 0;
    double texels_per_pixel = 1;  ///< Around the cursor
    TexelBox view{};              ///< Everything that may be seen of the plane
};

/// Sprites placed, taken up, moved, scaled, turned and put down by hand. Every gesture is one edit, drawn at
/// once, and undone as one. Knows no window, no sockets and no GL: points are on the plane.
class Hand {
  public:
    Hand(Extent extent, HandEdits& edits) : extent_{extent}, edits_{edits} {}

    /// The scene's patterns; another history of it forgets all that was known.
    void begin(std::int32_t patterns, std::int32_t side_texels);
    void look(const HandView& view);
    void set_animations(SpriteAnimations animations) { animations_ = std::move(animations); }
    const SpriteAnimations& animations() const { return animations_; }
    void set_covers(SpriteBook::Covers covers) { covers_ = std::move(covers); }

    /// The pattern that a click places; nothing: clicks take hold of sprites.
    void choose(std::optional<std::int32_t> pattern);
    std::optional<std::int32_t> placing() const { return placing_; }

    // ---- The pointer, with its left button. `snap`: turns by right steps.
    void hover(std::optional<HandPoint> at) { at_ = at; }
    /// False: the press is not the hand's; the camera may have it.
    bool press(const HandPoint& at, bool add);
    void drag(const HandPoint& at, bool moved, bool snap);
    void release(const HandPoint& at, bool moved);
    /// Lets go, and leaves all as it was. False: nothing was held.
    bool cancel();
    bool is_holding() const { return grip_.kind != Grip::Kind::none; }
    /// Whether something is being dragged just now, not framed.
    bool is_dragging() const { return carry_ != 0; }

    // ---- What is selected
    const std::vector<SpriteId>& selected() const { return selected_; }
    /// As they are drawn now, where they are at this step.
    std::vector<HandSprite> selection() const;
    std::optional<SelectionFrame> frame() const;
    void select(std::vector<SpriteId> ids);
    void select_all();
    const HandSprite* hovered() const;
    std::optional<FrameHandle> hovered_handle() const;
    /// The frame that is being drawn around several.
    std::optional<TexelBox> marquee() const;

    // ---- Edits of what is selected
    void remove();
    void duplicate();
    void raise(bool up);
    void change_together(HandChange how);
    void set_scale_of_each(double scale);
    void set_turns_of_each(double turns);
    /// While a slider moves: shown, and made when it is let go.
    void preview_scale(double scale);
    void preview_turns(double turns);
    void put_preview();
    /// Once all edits that are under way are answered: what is undone is the last of them. False: there is
    /// nothing to undo.
    bool go(HandEdits::Way way);

    // ---- What came
    void heard(const HandEdits::Outcome& outcome);
    void heard(const proto::EditDone& done);
    void ended(std::span<const std::uint32_t> holds) { carries_.end(holds); }
    /// What was on its way will not be answered: all that was not acknowledged is dropped.
    void lost();

    // ---- What is drawn
    SpriteBook& book() { return book_; }
    const SpriteBook& book() const { return book_; }
    const Carries& carries() const { return carries_; }
    std::vector<HeldSprite> held() const;
    /// A sprite as it is drawn now, where it is at this step. Nothing: there is none.
    std::optional<HandSprite> now(SpriteId id) const;
    /// The sprite that a click would place here.
    std::optional<HandSprite> ghost() const;
    /// What is in the hand and not put down.
    std::optional<HandSprite> dragged() const;
    /// For people: what just went wrong; taken once.
    std::string take_message() { return std::exchange(message_, {}); }
    const HandView& view() const { return view_; }

  private:
    struct Grip {
        enum class Kind { none, move, scale, turn, frame, place };
        Kind kind = Kind::none;
        HandPoint start{}, about{};
        SpriteId hit = 0;
        bool add = false, is_fresh = false;
    };
    std::optional<HandSprite> known(SpriteId id) const;
    std::vector<HandSprite> known_selection() const;
    bool go_now(HandEdits::Way way);
    void take_up();
    void put_down();
    void make(HandEdits::Changes changes, Carries::Id carry);
    void replace_each(const std::vector<HandSprite>& after);
    void place(const HandPoint& at);
    void preview_each(const std::function<void(HandSprite&)>& change);

    Extent extent_;
    HandEdits& edits_;
    SpriteBook book_;
    Carries carries_;
    SpriteBook::Covers covers_;
    HandView view_;
    SpriteAnimations animations_;
    std::int32_t side_texels_ = 1;
    std::optional<std::int32_t> placing_;
    std::optional<HandPoint> at_, frame_to_;
    std::vector<SpriteId> selected_;
    Grip grip_;
    Carries::Id carry_ = 0;  ///< Of the gesture under way; 0: none
    std::string message_;
    std::deque<HandEdits::Way> later_;  ///< Ways to go once nothing is under way
};

}  // namespace tessera
