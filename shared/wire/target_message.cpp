#include "shared/wire/target_message.h"

#include <string>
#include <unordered_set>

#include "proto/scene.pb.h"

#include "shared/page/page_key.h"

namespace tessera {

namespace {

constexpr std::int64_t max_place = std::int64_t{1} << 39;
constexpr std::uint32_t max_leg_steps = 1u << 28;

Error wrong(const std::string& field, const std::string& why) {
    return {ErrorCode::invalid_input, field + ": " + why};
}

bool is_place(std::int64_t x, std::int64_t y) noexcept {
    return x >= -max_place && x <= max_place && y >= -max_place && y <= max_place;
}

bool is_leg(std::uint32_t steps) noexcept { return steps >= 1 && steps <= max_leg_steps; }

}  // namespace

Result<MovingTarget> target_of(const proto::Target& message) {
    if (message.id() == 0) return wrong("id", "is 0; any other number");
    if (!is_place(message.x(), message.y())) return wrong("x, y", "are texels within ±2^39");
    if (message.legs_size() > max_target_legs)
        return wrong("legs", "are " + std::to_string(message.legs_size()) + "; at most 1024");
    if (message.first_step() < -max_step || message.first_step() > max_step)
        return wrong("first_step", "is from -2^62 to 2^62");
    MotionPoint from{message.x(), message.y()};
    std::vector<MovingTarget::Leg> legs;
    for (int i = 0; i < message.legs_size(); ++i) {
        const proto::Target::Leg& leg = message.legs(i);
        const std::string field = "legs[" + std::to_string(i) + "]";
        if (!is_place(leg.x(), leg.y())) return wrong(field, "x and y are texels within ±2^39");
        if (!is_leg(leg.steps())) return wrong(field + ".steps", "is from 1 to 2^28");
        legs.push_back({from, leg.steps()});
        from = {leg.x(), leg.y()};
    }
    if (legs.empty()) {
        legs.push_back({from, 1});
    } else {
        if (!is_leg(message.return_steps()))
            return wrong("return_steps", "is from 1 to 2^28: the way back from the last leg's end");
        legs.push_back({from, message.return_steps()});
    }
    return MovingTarget{legs, message.first_step()};
}

Result<std::vector<MovingTarget>> targets_of(
    const google::protobuf::RepeatedPtrField<proto::Target>& messages) {
    if (messages.size() > max_targets)
        return Error{ErrorCode::invalid_input,
                     ": are " + std::to_string(messages.size()) + "; at most " + std::to_string(max_targets)};
    std::vector<MovingTarget> targets;
    std::unordered_set<TargetId> ids;
    std::int64_t round = 0;
    for (int i = 0; i < messages.size(); ++i) {
        const std::string index = "[" + std::to_string(i) + "]";
        auto target = target_of(messages.Get(i));
        if (!target) return Error{target.error().code, index + "." + target.error().detail};
        if (!ids.insert(messages.Get(i).id()).second)
            return wrong(index + ".id",
                         "is " + std::to_string(messages.Get(i).id()) + ", as another target's; ids differ");
        if (target->moves()) {
            if (round != 0 && target->round_steps() != round)
                return wrong(index, "comes round in " + std::to_string(target->round_steps()) +
                                        " steps, another in " + std::to_string(round) +
                                        "; let legs and return_steps add up to the same number");
            round = target->round_steps();
        }
        targets.push_back(std::move(*target));
    }
    return targets;
}

}  // namespace tessera
