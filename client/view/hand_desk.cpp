#include "client/view/hand_desk.h"

#include <algorithm>
#include <cmath>

#include <google/protobuf/util/message_differencer.h>
#include <png.h>

#include "client/link/page_url.h"
#include "shared/wire/json.h"
#include "shared/wire/sprite_message.h"

namespace tessera {
namespace {

constexpr ClientTime told_every{40}, message_lasts{6000}, quiet_after_failure{1500};
constexpr std::size_t most_news = 20;
constexpr std::size_t most_gets = 8;  ///< At once, so that a list of sprites does not wait for many pictures
constexpr double glide = 0.35;        ///< Of the way to where a cursor was told to be, in a frame
constexpr std::int32_t most_picture_side = 256;

/// A pattern's picture: the top-left corner of a page.
Result<Rgba8Image> picture_of(const std::string& bytes, std::int32_t side) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    const auto broken = [&] { return Error{ErrorCode::io_failure, "the pattern's picture is no PNG image"}; };
    if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) return broken();
    const auto width = static_cast<std::int32_t>(png.width), height = static_cast<std::int32_t>(png.height);
    if (width > 4096 || height > 4096 || width < side || height < side) {
        png_image_free(&png);
        return broken();
    }
    png.format = PNG_FORMAT_RGBA;
    Rgba8Image page{width, height};
    if (!png_image_finish_read(&png, nullptr, page.bytes.data(), 0, nullptr)) return broken();
    Rgba8Image picture{side, side};
    for (std::int32_t y = 0; y < side; ++y) std::copy_n(page.row(y), 4 * side, picture.row(y));
    return picture;
}

/// The same person has the same colour wherever they are seen.
void paint(HandDesk::Person& person) {
    const double hue = std::fmod(static_cast<double>(person.session) * 0.381966, 1.0) * 6;
    const auto channel = [&](double shift) {
        const double k = std::fmod(shift + hue, 6.0);
        return static_cast<float>(1 - 0.55 * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
    };
    person.red = channel(5);
    person.green = channel(3);
    person.blue = channel(1);
}

std::string words_of(const google::protobuf::RepeatedPtrField<proto::Change>& changes) {
    if (changes.empty()) return "changed something";
    const auto several = [&](const char* one, const char* many) {
        return changes.size() == 1 ? std::string{one} : many + std::to_string(changes.size()) + " sprites";
    };
    const proto::Change& first = changes[0];
    if (first.has_place_sprite()) return several("placed a sprite", "placed ");
    if (first.has_move_sprite()) return several("moved a sprite", "moved ");
    if (first.has_remove_sprite()) return several("removed a sprite", "removed ");
    if (first.has_paint_map()) return "painted " + first.paint_map().block();
    if (first.has_set_parameter())
        return "set " + first.set_parameter().block() + " " + first.set_parameter().field();
    if (first.has_change_animation()) return "changed " + first.change_animation().block();
    if (first.has_set_target() || first.has_remove_target()) return "moved a target";
    return "set the clock";
}

}  // namespace

HandDesk::HandDesk(BackgroundStreamClient& stream, ServerAddress server, const SceneInfo& scene,
                   std::string name)
    : stream_{stream},
      gets_{std::move(server)},
      scene_{scene.id},
      edits_{[this](proto::Edit edit) { return stream_.edit(std::move(edit)); }, std::move(name)},
      hand_{scene.extent, edits_},
      targets_{edits_} {
    hand_.set_covers([this](const HandSprite& sprite, double u, double v) {
        const Rgba8Image* image = picture(shown_pattern(sprite, view_.step, hand_.animations()));
        if (!image) return true;
        const auto at = [&](double share) {
            return std::clamp(static_cast<std::int32_t>(share * image->width), 0, image->width - 1);
        };
        return image->row(at(v))[4 * at(u) + 3] > 12;
    });
}

std::string HandDesk::why_not() const {
    if (!hello_) return "not connected yet";
    if (!stream_status_.open) return "no connection";
    if (!hello_->takes_edits()) return "this scene takes no edits";
    return hello_->why_not().empty() ? "you may not edit here" : hello_->why_not();
}

std::string HandDesk::pattern_name(std::int32_t pattern) const {
    const std::string name =
        pattern >= 0 && pattern < pattern_count() ? hello_->patterns(pattern) : std::string{};
    return name.empty() ? "Pattern " + std::to_string(pattern + 1) : name;
}

const Rgba8Image* HandDesk::picture(std::int32_t pattern) const {
    const auto found = pictures_.find(pattern);
    return found == pictures_.end() ? nullptr : &found->second;
}

void HandDesk::want_picture(std::int32_t pattern) {
    if (pictures_.contains(pattern) || pattern < 0 || pattern >= pattern_count()) return;
    if (asked_pictures_.size() >= most_gets || asked_pictures_.contains(pattern) || view_.now < quiet_until_)
        return;
    if (gets_.ask(scene_target(scene_) + "/patterns/" + std::to_string(pattern) + ".png"))
        asked_pictures_[pattern] = true;
}

void HandDesk::want_pictures() {
    for (const HeldSprite& held : hand_.held()) want_picture(held.pattern);
    for (const auto& [session, person] : people_)
        if (person.held) {
            want_picture(shown_pattern(*person.held, view_.step, hand_.animations()));
            want_frames(*person.held);
        }
    for (const HandSprite& sprite : hand_.selection()) want_frames(sprite);
}

/// All that it will show while it is in a hand, before it does.
void HandDesk::want_frames(const HandSprite& sprite) {
    if (!has_frames(sprite, hand_.animations())) return;
    for (const std::int32_t pattern : hand_.animations()[*sprite.animation]->patterns) want_picture(pattern);
}

void HandDesk::set_density(const Density& density) {
    proto::Change change;
    change.mutable_change_animation()->set_block(density.block);
    change.mutable_change_animation()->set_density(density.density);
    edits_.make({std::move(change)});
}

void HandDesk::say(std::string message, ClientTime now) {
    if (message.empty()) return;
    message_ = std::move(message);
    message_until_ = now + message_lasts;
}

void HandDesk::be_at(std::optional<HandPoint> at, int level) {
    at_ = at;
    level_ = level;
}

void HandDesk::advance(const HandView& view) {
    view_ = view;
    if (view.now > message_until_) message_.clear();
    stream_status_ = stream_.status();
    hear_hello();
    hear_edits(view.now);
    hear_people(view.now);
    take_gets();
    hand_.look(view);
    say(hand_.take_message(), view.now);
    if (is_open && !takes_edits()) is_open = false;
    want_pictures();
    targets_.advance();
    for (MapBrush& brush : brushes_) brush.advance();
    ask();
    be_present(view.now);
}

void HandDesk::hear_hello() {
    auto hello = stream_.hello();
    if (!hello) return;
    const bool is_another = !hello_ || hello->lineage() != hello_->lineage() ||
                            hello->fingerprint() != hello_->fingerprint() ||
                            hello->patterns_size() != hello_->patterns_size();
    const bool is_new_session = hello->session() != session_;
    session_ = hello->session();
    hello_ = std::move(hello);
    if (is_another) {
        pictures_.clear();
        hand_.set_animations({});
        hand_.begin(hello_->patterns_size(), static_cast<std::int32_t>(hello_->pattern_side_texels()));
        edits_.forget_history();
        others_.clear();
    }
    if (is_another || is_new_session) {
        hand_.book().doubt();
        told_presence_.Clear();
        asks_editables_ = true;
    }
}

void HandDesk::hear_edits(ClientTime now) {
    for (const auto& [id, fate] : stream_.take_fates()) {
        const auto outcome = edits_.hear(id, fate);
        if (!outcome) continue;
        hand_.heard(*outcome);
        if (outcome->is_in) targets_.take(outcome->changes);
    }
    for (const proto::EditDone& done : stream_.take_edits()) {
        hand_.heard(done);
        others_.heard(done, now);
        targets_.take({done.changes().begin(), done.changes().end()});
        for (const proto::Change& change : done.changes())
            if (change.has_change_animation() && change.change_animation().has_density())
                for (Density& density : densities_)
                    if (density.block == change.change_animation().block())
                        density.density = change.change_animation().density();
        News news{.who = done.author(), .what = words_of(done.changes()), .at = now};
        if (const auto found = people_.find(done.session()); found != people_.end()) {
            news.who = found->second.name;
            news.red = found->second.red;
            news.green = found->second.green;
            news.blue = found->second.blue;
        }
        if (news.who.empty()) news.who = "Somebody";
        if (!news_.empty() && news_.front().who == news.who && news_.front().what == news.what)
            news_.pop_front();
        news_.push_front(std::move(news));
        if (news_.size() > most_news) news_.pop_back();
    }
}

void HandDesk::hear_people(ClientTime now) {
    std::map<std::uint64_t, Person> people;
    for (const proto::Present::Person& told : stream_.people()) {
        Person person;
        if (const auto known = people_.find(told.session()); known != people_.end())
            person = std::move(known->second);
        person.session = told.session();
        person.name = told.name().empty() ? "Somebody" : told.name();
        paint(person);
        const proto::Presence& presence = told.presence();
        if (presence.has_x() && presence.has_y() && std::abs(presence.x()) < 1e12 &&
            std::abs(presence.y()) < 1e12) {
            const HandPoint goal{static_cast<std::int64_t>(presence.x() * sprite_units),
                                 static_cast<std::int64_t>(presence.y() * sprite_units)};
            if (!person.at) person.at = goal;
            if (*person.at != goal) person.moved = now;
            const auto nearer = [](std::int64_t from, std::int64_t to) {
                const auto way = static_cast<double>(to - from);
                return std::abs(way) < sprite_units ? to : from + static_cast<std::int64_t>(way * glide);
            };
            person.at = HandPoint{nearer(person.at->x, goal.x), nearer(person.at->y, goal.y)};
        } else {
            person.at.reset();
        }
        person.selected.assign(presence.selected().begin(), presence.selected().end());
        person.held.reset();
        if (presence.has_held())
            if (auto held = hand_sprite_of(presence.held(), pattern_count(),
                                           static_cast<std::int32_t>(pattern_side_texels())))
                person.held = std::move(*held);
        if (person.held)
            others_.hold(person.session, *person.held, hand_.book().find(person.held->id));
        else
            others_.let_go(person.session, now);
        people.emplace(person.session, std::move(person));
    }
    for (const auto& [session, person] : people_)
        if (!people.contains(session)) others_.let_go(session, now);
    people_ = std::move(people);
    others_.tidy(now);
}

void HandDesk::ask() {
    if (!hello_ || view_.now < quiet_until_) return;
    if (asks_editables_ && gets_.ask(scene_target(scene_) + "/editables")) asks_editables_ = false;
    if (!is_open || asked_boxes_.size() > 2) return;
    if (const auto box = hand_.book().take_question()) {
        const std::string target = scene_target(scene_) + "/sprites?x0=" + std::to_string(box->x0) +
                                   "&y0=" + std::to_string(box->y0) + "&x1=" + std::to_string(box->x1) +
                                   "&y1=" + std::to_string(box->y1);
        if (gets_.ask(target))
            asked_boxes_[target] = *box;
        else
            hand_.book().no_answer();
    }
}

void HandDesk::set_animations(const proto::SceneEditables& editables) {
    SpriteAnimations animations;
    for (const proto::SpriteAnimation& told : editables.sprite_animations()) {
        auto frames = sprite_frames_of(told, pattern_count());
        if (!frames) return hand_.set_animations({});  // of another history of the scene: told again
        animations.push_back(std::move(*frames));
    }
    hand_.set_animations(std::move(animations));
}

void HandDesk::take_gets() {
    for (const BackgroundGets::Got& got : gets_.take(2)) {
        const bool is_good = got.reply && got.reply->status == 200;
        if (!is_good) quiet_until_ = view_.now + quiet_after_failure;
        if (const auto box = asked_boxes_.find(got.target); box != asked_boxes_.end()) {
            proto::SpriteList list;
            if (is_good && read_json_leniently(got.reply->body, "sprites", list)) {
                hand_.book().answer(box->second, list);
            } else {
                hand_.book().no_answer();
                hand_.book().doubt();
            }
            asked_boxes_.erase(box);
        } else if (got.target.ends_with("/editables")) {
            proto::SceneEditables editables;
            if (!is_good || !read_json_leniently(got.reply->body, "editables", editables)) {
                asks_editables_ = !(got.reply && got.reply->status == 404);
                continue;
            }
            set_animations(editables);
            targets_.set(editables.targets());
            densities_.clear();
            for (const auto& animation : editables.animations())
                densities_.push_back({animation.block(), animation.density()});
            brushes_.clear();
            for (const proto::EditableGrid& grid : editables.maps()) {
                MapBrush& brush = brushes_.emplace_back(grid, edits_);
                brush.value = grid.most();
                brush.radius_texels = 2 * static_cast<double>(grid.entry_texels());
            }
            // What the scene has
            if (pattern_count() == 0 && tool == Tool::hand)
                tool = brushes_.empty() ? Tool::target : Tool::brush;
        } else {
            const auto asked = std::ranges::find_if(asked_pictures_, [&](const auto& one) {
                return got.target.ends_with("/" + std::to_string(one.first) + ".png");
            });
            if (asked == asked_pictures_.end()) continue;
            const std::int32_t pattern = asked->first;
            asked_pictures_.erase(asked);
            if (!is_good) continue;
            auto image =
                picture_of(got.reply->body,
                           std::min(static_cast<std::int32_t>(pattern_side_texels()), most_picture_side));
            if (!image) continue;
            pictures_[pattern] = std::move(*image);
            new_pictures_.push_back(pattern);
        }
    }
}

void HandDesk::be_present(ClientTime now) {
    if (!stream_status_.open || now - told_at_ < told_every) return;
    proto::Presence presence;
    if (at_) {
        presence.set_x(static_cast<double>(at_->x) / sprite_units);
        presence.set_y(static_cast<double>(at_->y) / sprite_units);
    }
    presence.set_level(static_cast<std::uint32_t>(std::max(0, level_)));
    for (const SpriteId id : hand_.selected()) {
        if (presence.selected_size() == 64) break;
        presence.add_selected(id);
    }
    if (const auto dragged = hand_.dragged()) write_hand_sprite(*dragged, *presence.mutable_held());
    if (google::protobuf::util::MessageDifferencer::Equals(presence, told_presence_)) return;
    stream_.be_present(presence);
    told_presence_ = std::move(presence);
    told_at_ = now;
}

void HandDesk::fill(ViewFrame& frame) const {
    frame.holds = hand_.carries().holds();
    for (PageHold& hold : others_.holds()) frame.holds.push_back(std::move(hold));
    if (!others_.empty()) frame.held = others_.held(view_.step, hand_.animations(), hand_.book().in_order());
    for (const HeldSprite& sprite : hand_.held())
        if (is_open || sprite.hold != 0) frame.held.push_back(sprite);
    for (PageHold& hold : frame.holds)
        if (!hold.lifted.empty() && !has_pictures(hold.id)) {
            hold.lifted.clear();
            hold.lifted_boxes.clear();
            std::erase_if(frame.held, [&](const HeldSprite& sprite) { return sprite.hold == hold.id; });
        }
}

bool HandDesk::has_pictures(Carries::Id carry) const {
    const auto is_here = [&](std::int32_t pattern) {
        return pattern < 0 || pattern >= pattern_count() || picture(pattern) != nullptr;
    };
    const std::span<const HandSprite> own = hand_.carries().now(carry);
    return std::ranges::all_of(own.empty() ? others_.now(carry) : own, [&](const HandSprite& sprite) {
        return has_frames(sprite, hand_.animations())
                   ? std::ranges::all_of(hand_.animations()[*sprite.animation]->patterns, is_here)
                   : is_here(sprite.pattern);
    });
}

}  // namespace tessera
