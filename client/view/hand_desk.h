#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/link/background_gets.h"
#include "client/link/background_stream_client.h"
#include "client/link/scene_info.h"
#include "client/view/hand/hand.h"
#include "client/view/hand/map_brush.h"
#include "client/view/hand/others_hands.h"
#include "client/view/hand/target_hand.h"
#include "client/view/view_frame.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// Everything that hands do to a scene, and what it takes: the stream that brings edits there and back, what
/// is asked for by HTTP (sprites around the view, pictures of patterns, what else can be edited), the tools,
/// and who else is here. No window.
class HandDesk {
  public:
    /// `stream` outlives this. `name`: of who edits, for people.
    HandDesk(BackgroundStreamClient& stream, ServerAddress server, const SceneInfo& scene, std::string name);

    enum class Tool { hand, brush, target };
    bool is_open = false;  ///< Whether hands edit, or only look.
    Tool tool = Tool::hand;

    /// Whether anybody may edit the scene, and whether this one may.
    bool takes_edits() const { return hello_ && hello_->takes_edits(); }
    bool may_edit() const { return hello_ && hello_->may_edit() && stream_status_.open; }
    /// Where it may not: why, for people.
    std::string why_not() const;

    /// Once a frame, before it is made: hears what came, and sends what is to be sent.
    void advance(const HandView& view);
    /// What of it the frame shows.
    void fill(ViewFrame& frame) const;
    /// What a frame ended, and the pictures that came since the last one.
    void drawn(const ResidencyFrame& frame) {
        hand_.ended(frame.ended_holds);
        others_.ended(frame.ended_holds);
    }
    /// Patterns whose pictures are new since the last call: for PlaneScene::held_patterns().
    std::vector<std::int32_t> take_new_pictures() { return std::exchange(new_pictures_, {}); }

    // ---- What there is
    Hand& hand() { return hand_; }
    const Hand& hand() const { return hand_; }
    HandEdits& edits() { return edits_; }
    TargetHand& targets() { return targets_; }
    /// The maps that can be painted, and the one that is.
    std::vector<MapBrush>& brushes() { return brushes_; }
    MapBrush* brush() { return brush_ < brushes_.size() ? &brushes_[brush_] : nullptr; }
    std::size_t brush_index() const { return brush_; }
    void choose_brush(std::size_t brush) { brush_ = brush; }
    struct Density {
        std::string block;
        double density = 1;
    };
    std::vector<Density>& densities() { return densities_; }
    void set_density(const Density& density);
    std::int32_t pattern_count() const { return hello_ ? hello_->patterns_size() : 0; }
    std::string pattern_name(std::int32_t pattern) const;
    double pattern_side_texels() const { return hello_ ? hello_->pattern_side_texels() : 1; }
    /// Straight sRGB; null until it has come.
    const Rgba8Image* picture(std::int32_t pattern) const;
    /// Asks for the picture, if it is not here.
    void want_picture(std::int32_t pattern);
    void undo() { hand_.go(HandEdits::Way::undoing); }
    void redo() { hand_.go(HandEdits::Way::redoing); }

    // ---- People
    struct Person {
        std::uint64_t session = 0;
        std::string name;
        float red = 1, green = 1, blue = 1;
        std::optional<HandPoint> at;  ///< Where the hand is; glides to where it was told to be.
        ClientTime moved{};
        std::vector<SpriteId> selected;
        std::optional<HandSprite> held;
    };
    const std::map<std::uint64_t, Person>& people() const { return people_; }
    /// Where this one's hand is, for the others.
    void be_at(std::optional<HandPoint> at, int level);
    const std::optional<HandPoint>& cursor() const { return at_; }
    struct News {
        std::string who, what;
        ClientTime at{};
        float red = 1, green = 1, blue = 1;
    };
    /// The last edits of others, the newest first.
    const std::deque<News>& news() const { return news_; }
    /// For people: what just went wrong, for some seconds. Empty: nothing.
    const std::string& message() const { return message_; }
    void say(std::string message) { say(std::move(message), view_.now); }

  private:
    void hear_hello();
    void hear_people(ClientTime now);
    void hear_edits(ClientTime now);
    void take_gets();
    void ask();
    void be_present(ClientTime now);
    void set_animations(const proto::SceneEditables& editables);
    void want_pictures();
    void want_frames(const HandSprite& sprite);
    /// Whether all that its sprites will show is here. Until then the pages show them, where they were.
    bool has_pictures(Carries::Id carry) const;
    void say(std::string message, ClientTime now);

    BackgroundStreamClient& stream_;
    BackgroundGets gets_;
    std::string scene_;
    HandEdits edits_;
    Hand hand_;
    OthersHands others_;
    TargetHand targets_;
    std::vector<MapBrush> brushes_;
    std::size_t brush_ = 0;
    std::vector<Density> densities_;
    std::optional<proto::ServerHello> hello_;
    std::uint64_t session_ = 0;
    StreamStatus stream_status_;
    std::map<std::int32_t, Rgba8Image> pictures_;
    std::map<std::int32_t, bool> asked_pictures_;
    std::vector<std::int32_t> new_pictures_;
    std::map<std::string, TexelBox> asked_boxes_;
    bool asks_editables_ = false;
    ClientTime quiet_until_{};
    std::map<std::uint64_t, Person> people_;
    std::deque<News> news_;
    proto::Presence told_presence_;
    std::optional<HandPoint> at_;
    int level_ = 0;
    ClientTime told_at_{};
    std::string message_;
    ClientTime message_until_{};
    HandView view_;
};

}  // namespace tessera
