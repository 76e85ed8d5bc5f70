// Targets and sprites with animations as messages say them.
#include <gmock/gmock.h>

#include "proto/scene.pb.h"

#include "shared/wire/sprite_message.h"
#include "shared/wire/target_message.h"

namespace tessera {
namespace {

using testing::HasSubstr;

proto::Scene two_targets() {
    proto::Scene scene;
    for (int i = 1; i <= 2; ++i) {
        proto::Target& target = *scene.add_targets();
        target.set_id(static_cast<std::uint64_t>(i));
        proto::Target::Leg& leg = *target.add_legs();
        leg.set_x(100 * i);
        leg.set_steps(30);
        target.set_return_steps(10);
    }
    return scene;
}

TEST(TargetMessages, AreLegsAndTheWayBack) {
    const auto targets = targets_of(two_targets().targets());
    ASSERT_TRUE(targets) << targets.error().detail;
    EXPECT_EQ((*targets)[1].round_steps(), 40);
    EXPECT_EQ((*targets)[1].at(15).x, 100);
    EXPECT_EQ((*targets)[1].at(35).x, 100);
}

TEST(TargetMessages, AreRefusedByIndexAndField) {
    const auto refusal = [](const proto::Scene& scene) {
        const auto targets = targets_of(scene.targets());
        return targets ? std::string{} : targets.error().detail;
    };
    proto::Scene scene = two_targets();
    scene.mutable_targets(1)->set_return_steps(11);
    EXPECT_THAT(refusal(scene), HasSubstr("[1]: comes round in 41 steps, another in 40"));
    scene = two_targets();
    scene.mutable_targets(1)->set_id(1);
    EXPECT_THAT(refusal(scene), HasSubstr("[1].id: is 1, as another target's"));
    scene = two_targets();
    scene.mutable_targets(0)->set_return_steps(0);
    EXPECT_THAT(refusal(scene), HasSubstr("[0].return_steps: "));
    scene = two_targets();
    scene.mutable_targets(0)->mutable_legs(0)->set_steps((1u << 28) + 1);
    EXPECT_THAT(refusal(scene), HasSubstr("[0].legs[0].steps: "));
    scene = two_targets();
    scene.mutable_targets(0)->set_x(std::int64_t{1} << 40);
    EXPECT_THAT(refusal(scene), HasSubstr("[0].x, y: "));
    scene.clear_targets();
    for (int i = 0; i < 257; ++i) scene.add_targets()->set_id(static_cast<std::uint64_t>(i) + 1);
    EXPECT_THAT(refusal(scene), HasSubstr("are 257; at most 256"));
}

TEST(SpriteAnimations, AreReadAndWrittenBack) {
    proto::SpriteAnimation message;
    message.add_frames()->set_pattern(2);
    message.add_frames()->set_pattern(1);
    message.mutable_frames(1)->set_steps(5);
    const auto frames = sprite_frames_of(message, 3);
    ASSERT_TRUE(frames);
    const std::vector<std::shared_ptr<const SpriteFrames>> animations{*frames};
    proto::SpritePlacement placed;
    placed.set_id(9);
    placed.set_animation(0);
    placed.set_phase(-4);
    const auto sprite = sprite_of(placed, {3, 16, animations});
    ASSERT_TRUE(sprite) << sprite.error().detail;
    EXPECT_EQ(pattern_at(*sprite, 4), 2);
    EXPECT_EQ(pattern_at(*sprite, 5), 1);
    proto::SpritePlacement again;
    write_sprite(*sprite, again);
    EXPECT_EQ(again.animation(), 0u);
    EXPECT_TRUE(again.has_animation());
    EXPECT_EQ(again.phase(), -4);
    placed.set_animation(1);
    const auto unknown = sprite_of(placed, {3, 16, animations});
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().detail, HasSubstr("animation: is 1; the scene has 1"));
    const auto outside = sprite_frames_of(message, 2);
    ASSERT_FALSE(outside);
    EXPECT_THAT(outside.error().detail, HasSubstr("frames[0].pattern: is 2; the set has 2"));
}

}  // namespace
}  // namespace tessera
