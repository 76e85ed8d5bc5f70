#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/render/held_map.h"
#include "client/residency/page_holds.h"
#include "client/residency/page_requests.h"
#include "client/view/hand/hand_sprite.h"

namespace tessera {

/// What is drawn over the pages, from when a hand takes it up until the pages show it where it was put: each
/// gesture is one carry, and ends alone.
class Carries {
  public:
    using Id = std::uint32_t;
    /// Ids count from the one after `first` on.
    explicit Carries(Id first = 0) : last_{first} {}
    /// After so long a page that does not come is no longer waited for.
    static constexpr ClientTime longest_melt{5000};

    /// `taken`: as they were, of those that were; `now`: as they are, of those that are.
    Id begin(std::vector<HandSprite> taken, std::vector<HandSprite> now);
    /// They are so now.
    void drag(Id carry, std::vector<HandSprite> now);
    /// Nothing came of it: all is as the pages show it.
    void drop(Id carry);
    /// An edit makes it so: on its way; then in, with what it changed.
    void sent(Id carry);
    void made(Id carry, std::uint64_t revision, std::vector<TexelBox> dirty, ClientTime now);
    /// The pages show these.
    void end(std::span<const std::uint32_t> holds);
    /// Lets go of what is late.
    void tidy(ClientTime now);
    void clear() { all_.clear(); }

    bool empty() const { return all_.empty(); }
    std::span<const HandSprite> taken(Id carry) const;
    std::span<const HandSprite> now(Id carry) const;
    /// A sprite as the last carry that has it shows it. Null: none has it.
    const HandSprite* find(SpriteId id) const;
    /// Whether a carry took it away.
    bool is_gone(SpriteId id) const;

    /// In the order of drawing, and with them those of `others`, which the pages show, that lie over them:
    /// at most `most_above`. Where these are translucent they are a little denser meanwhile. `others`: in the
    /// order of drawing.
    std::vector<HeldSprite> held(Step step, const SpriteAnimations& animations = {},
                                 std::span<const HandSprite* const> others = {}) const;
    static constexpr std::size_t most_above = 256;
    std::vector<PageHold> holds() const;

  private:
    struct Carry {
        Id id = 0;
        std::vector<HandSprite> taken, now;
        bool is_sent = false;
        std::uint64_t revision = 0;
        std::vector<TexelBox> dirty{};
        ClientTime made_at{};
    };
    Carry* find_carry(Id carry);
    const Carry* find_carry(Id carry) const;

    std::vector<Carry> all_;  ///< The latest last
    Id last_;
};

/// As the shader draws it, where it is at a step.
HeldSprite held_sprite(const HandSprite& sprite, Step step, const SpriteAnimations& animations);

}  // namespace tessera
