#pragma once

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/end_to_end/edits/edited_scenes.h"
#include "tests/unit/server/edits/edited_pattern.h"

namespace tessera::test {

inline std::uint64_t fresh_seed() {
    const char* const given = std::getenv("TESSERA_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
}

/// The edited pattern with all of its textures above each other, under sprites.
class MixedScene {
  public:
    MixedScene() {
        files_.load();
        std::string json = EditedPattern::json("everything", true);
        json.replace(
            json.find(R"({"name": "moving")"), 0,
            R"({"name": "everything", "layers": {"textures": ["mask", "fallen", "flowers", "lights", "glints"]}}, )");
        std::ofstream{files_.folder() / "scene.json"} << json;
    }
    /// A server whose edits are kept in `edits`.
    Program serve(const tests::TemporaryFolder& edits, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> words{"serve",       "--scenes", files_.folder().string(), "--listen",
                                       "127.0.0.1:0", "--edits",  edits.path.string()};
        words.insert(words.end(), more.begin(), more.end());
        return Program{words};
    }
    static std::optional<Reply> send(RawClient& client, const proto::Edit& edit) {
        if (!client.send(post("meadow", write_brief_json(edit)))) return std::nullopt;
        return client.receive();
    }

  private:
    EditedPattern files_;
};

/// Edits of every kind. Pages at a step do not depend on when they were accepted.
class MixedEdits {
  public:
    explicit MixedEdits(std::uint64_t seed) : engine_{seed} {}
    std::uint64_t below(std::uint64_t count) {
        return std::uniform_int_distribution<std::uint64_t>{0, count - 1}(engine_);
    }
    proto::Edit next() {
        proto::Edit edit = new_edit();
        for (std::uint64_t left = 1 + below(4) / 3; left > 0; --left) add(*edit.add_changes());
        return edit;
    }

  private:
    double place() { return static_cast<double>(below(4)) * 1024 + static_cast<double>(below(2048)) / 4; }
    void add(proto::Change& change) {
        switch (const std::uint64_t kind = below(20)) {
            case 0:
                // These touch all pages
                return below(2) == 0 ? set_parameter(change) : change_animation(change);
            case 1:
            case 2:
            case 3:
                return kind == 2 && below(2) == 0 ? change.mutable_remove_target()->set_id(1 + below(3))
                                                  : set_target(*change.mutable_set_target());
            case 4: {
                proto::ClockChange& clock = *change.mutable_set_clock();
                if (below(2) == 0) clock.set_playing(below(2) == 0);
                if (below(3) == 0) clock.set_steps_per_second(static_cast<double>(below(120)) / 4);
                if (below(3) != 0) clock.set_step(static_cast<std::int64_t>(below(5000)));
                return;
            }
            case 5:
            case 6:
            case 7:
            case 8:
            case 9:
            case 10:
                return paint(*change.mutable_paint_map());
            case 11:
            case 12:
                return change.mutable_remove_sprite()->set_id(1 + below(40));
            case 13:
            case 14:
            case 15: {
                proto::SpriteMove& move = *change.mutable_move_sprite();
                move.set_id(1 + below(40));
                move.set_x(place());
                move.set_y(place());
                if (below(3) == 0) move.set_turn(static_cast<double>(below(64)) / 64);
                if (below(3) == 0) move.set_scale(scale());
                if (below(3) == 0) move.set_order(static_cast<std::int32_t>(below(5)));
                if (below(3) == 0) move.set_pattern(static_cast<std::uint32_t>(below(4)));
                return;
            }
            default:
                return place_sprite(*change.mutable_place_sprite());
        }
    }
    double scale() { return static_cast<double>(1 + below(256)) / 64; }
    /// Some stand from a step on, or until one, or move by themselves: these touch all pages on their way.
    void place_sprite(proto::SpritePlacement& sprite) {
        sprite.set_id(1 + below(40));
        sprite.set_x(place());
        sprite.set_y(place());
        sprite.set_pattern(static_cast<std::uint32_t>(below(4)));
        sprite.set_turn(static_cast<double>(below(64)) / 64);
        sprite.set_scale(scale());
        sprite.set_order(static_cast<std::int32_t>(below(5)));
        const auto some_step = [&] { return static_cast<std::int64_t>(below(400)); };
        if (below(6) == 0) sprite.set_first_step(some_step());
        if (below(6) == 0) sprite.set_end_step(400 + some_step());
        if (below(8) != 0) return;
        proto::SpritePath& path = *sprite.mutable_path();
        path.set_to_x(place());
        path.set_to_y(place());
        path.set_first_step(some_step());
        path.set_steps(static_cast<std::uint32_t>(1 + below(300)));
        path.set_then(static_cast<proto::SpritePath::Then>(below(3)));
    }
    void set_parameter(proto::Change& change) {
        proto::ParameterChange& parameter = *change.mutable_set_parameter();
        if (below(2) == 0) {
            parameter.set_block("which");
            parameter.set_field("count");
            parameter.mutable_value()->set_integer(static_cast<std::int64_t>(below(70)));  // 0 is refused
        } else {
            parameter.set_block("mixture");
            parameter.set_field("materials[2].entries[0].weight");
            parameter.mutable_value()->set_integer(static_cast<std::int64_t>(1 + below(5)));
        }
    }
    void change_animation(proto::Change& change) {
        proto::AnimationChange& animation = *change.mutable_change_animation();
        animation.set_block("blink");
        animation.set_step(static_cast<std::int64_t>(100 * below(40)));
        if (below(2) == 0)
            animation.set_density(static_cast<double>(below(6)) / 2);
        else
            animation.mutable_rest()->set_integer(static_cast<std::int64_t>(below(60)));
    }
    void set_target(proto::Target& target) {
        target.set_id(1 + below(3));
        target.set_x(static_cast<std::int64_t>(place()));
        target.set_y(static_cast<std::int64_t>(place()));
        if (below(2) == 0) return;
        proto::Target::Leg& leg = *target.add_legs();
        leg.set_x(static_cast<std::int64_t>(place()));
        leg.set_y(static_cast<std::int64_t>(place()));
        leg.set_steps(120);
        target.set_return_steps(80);
    }
    void paint(proto::MapPaint& paint) {
        const auto [block, side, values] = std::vector<std::tuple<const char*, std::uint64_t, std::uint64_t>>{
            {"areas", 16, 2}, {"kinds", 32, 3}, {"mask", 64, 2}}[below(3)];
        paint.set_block(block);
        const std::uint64_t width = 1 + below(4), height = 1 + below(4);
        paint.set_width(static_cast<std::uint32_t>(width));
        paint.set_height(static_cast<std::uint32_t>(height));
        paint.set_x(static_cast<std::int64_t>(below(side - width + 1)));
        paint.set_y(static_cast<std::int64_t>(below(side - height + 1)));
        paint.set_value(static_cast<std::int32_t>(below(values + (below(20) == 0 ? 1 : 0))));
    }

    std::mt19937_64 engine_;
};

/// A page at a step, and what was last seen of it.
struct SeenPage {
    int z = 0, x = 0, y = 0, step = 0;
    const char* parameter = "";  ///< What the request tells animations that it drives; empty: nothing.
    std::string tag{}, bytes{};
    std::uint64_t touched = 0;  ///< The last edit whose dirty boxes come near it.

    std::string address() const {
        return "/scenes/meadow/" + std::to_string(z) + "/" + std::to_string(x) + "/" + std::to_string(y) +
               ".png?accuracy=fast&step=" + std::to_string(step) + (*parameter == '\0' ? "" : "&parameter=") +
               parameter;
    }
    bool comes_near(const proto::DirtyBox& box) const {
        const int level = 6 - z;
        const std::int64_t side = std::int64_t{256} << level, more = std::int64_t{64} << level;
        return box.x0() < (x + 1) * side + more && box.x1() > x * side - more &&
               box.y0() < (y + 1) * side + more && box.y1() > y * side - more;
    }
};

/// The second shows what the first does: the first frame.
inline constexpr std::array<const char*, 3> parameters_to_see{"", "0.2", "0.6"};

/// Of each place, one after the other, one page for each parameter.
inline std::vector<SeenPage> pages_to_see() {
    std::vector<SeenPage> pages;
    for (const auto& [z, x, y] : {std::tuple{0, 0, 0},
                                  {2, 0, 0},
                                  {3, 1, 0},
                                  {4, 2, 2},
                                  {5, 0, 0},
                                  {6, 0, 0},
                                  {6, 2, 2},
                                  {6, 4, 8},
                                  {6, 12, 12},
                                  {6, 40, 40}})
        for (const char* parameter : parameters_to_see) pages.push_back({z, x, y, 77 + 130 * x, parameter});
    return pages;
}

}  // namespace tessera::test
