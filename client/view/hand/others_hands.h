#pragma once

#include <cstdint>
#include <map>

#include "client/view/hand/carries.h"

namespace tessera {

namespace proto {
class EditDone;
}

/// What other people hold: lifted from the pages here, too, and drawn where they have it, until the pages
/// show where it was put down.
class OthersHands {
  public:
    /// How long after something was let go the edit that puts it down may come.
    static constexpr ClientTime longest_wait{800};

    /// Somebody holds this sprite now. `there`: where the pages show it; null: nowhere that is known.
    void hold(std::uint64_t session, const HandSprite& sprite, const HandSprite* there);
    /// Somebody holds nothing now.
    void let_go(std::uint64_t session, ClientTime now);
    /// An edit was made: perhaps it puts down what somebody held.
    void heard(const proto::EditDone& done, ClientTime now);
    void ended(std::span<const std::uint32_t> holds) { carries_.end(holds); }
    void tidy(ClientTime now);
    void clear();

    /// `others`: see Carries::held().
    std::vector<HeldSprite> held(Step step, const SpriteAnimations& animations = {},
                                 std::span<const HandSprite* const> others = {}) const {
        return carries_.held(step, animations, others);
    }
    bool empty() const { return carries_.empty(); }
    std::vector<PageHold> holds() const { return carries_.holds(); }
    /// As they are held now.
    std::span<const HandSprite> now(Carries::Id carry) const { return carries_.now(carry); }

  private:
    struct Held {
        Carries::Id carry = 0;
        SpriteId sprite = 0;
        bool is_let_go = false;
        ClientTime let_go_at{};
    };
    Carries carries_{0x80000000U};  ///< Ids apart from those of our own
    std::map<std::uint64_t, Held> held_;
};

}  // namespace tessera
