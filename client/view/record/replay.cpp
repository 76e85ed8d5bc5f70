#include "client/view/record/replay.h"

#include <cstdio>
#include <memory>
#include <optional>

#include "client/render/gl_context.h"
#include "client/view/frame_painter.h"
#include "client/view/record/frame_message.h"
#include "client/view/record/recorded_source.h"
#include "client/view/record/session.pb.h"
#include "client/view/record/session_file.h"
#include "client/view/record/session_recorder.h"

namespace tessera {
namespace {

constexpr std::size_t most_differences = 8;

class Replay {
  public:
    explicit Replay(const std::function<bool(const FrameTarget&, std::uint64_t)>& shown) : shown_{shown} {}

    /// What is wrong with it, if it cannot be gone on with; else an entry that was dealt with.
    Result<void> take(const view::SessionEntry& entry) {
        if (entry.has_head()) return begin(entry.head());
        if (!painter_) return Error{ErrorCode::invalid_input, "the recording does not begin with a head"};
        switch (entry.entry_case()) {
            case view::SessionEntry::kFrame:
                return frame(entry.frame());
            case view::SessionEntry::kPicture:
                return picture(entry.picture());
            case view::SessionEntry::kPattern:
                return pattern(entry.pattern());
            case view::SessionEntry::kSecond:
                return begin_second(entry.second());
            case view::SessionEntry::kEndSecond:
                end_second();
                break;
            case view::SessionEntry::kHeights: {
                auto heights = read_heights(entry.heights());
                if (!heights) return heights.error();
                heights_ = std::move(*heights);
                break;
            }
            case view::SessionEntry::kResizeSlots:
                for (PlaneScene* scene : scenes())
                    if (const auto done = scene->resize(entry.resize_slots()); !done) return done.error();
                break;
            case view::SessionEntry::kEnd:
                report.end = entry.end().reason();
                break;
            default:
                break;
        }
        return {};
    }
    bool wants_more() const { return wants_more_; }

    ReplayReport report;

  private:
    Result<void> begin(const view::SessionHead& head) {
        if (painter_ || head.extent_n() > max_level)
            return Error{ErrorCode::invalid_input, "the recording's head is broken"};
        report.scene = head.scene();
        report.recorded_by = head.program();
        report.recorded_with = head.renderer();
        extent_ = Extent{static_cast<std::uint8_t>(head.extent_n())};
        if (const auto made = first_.make(extent_, head.cache()); !made) return made.error();
        painter_.emplace(*first_.scene);
        return {};
    }

    Result<void> begin_second(const view::CacheSettings& settings) {
        painter_->set_second(nullptr);
        if (const auto made = second_.make(extent_, settings); !made) return made.error();
        painter_->set_second(second_.scene.get());
        for (const view::HeldPattern& pattern : patterns_) show(pattern, *second_.scene);
        return {};
    }

    void end_second() {
        painter_->set_second(nullptr);
        second_ = {};
    }

    Result<void> frame(const view::RecordedFrame& message) {
        auto frame = read_frame(message, heights_);
        if (!frame) return frame.error();
        const PlanePoint& at = frame->camera.ground;
        if (at.x < 0 || at.y < 0 || at.x >= extent_.side_texels() || at.y >= extent_.side_texels())
            return Error{ErrorCode::invalid_input, "a recorded camera lies outside the extent"};
        if (message.sources_size() != (second_.scene ? 2 : 1))
            return Error{ErrorCode::invalid_input, "a recorded frame lacks what a source of pages said"};
        first_.source->begin_frame(message.sources(0));
        if (second_.scene) second_.source->begin_frame(message.sources(1));
        ++report.frames;
        painter_->update(*frame);
        if (!first_.source->is_same() || (second_.scene && !second_.source->is_same()))
            differ("asks for other pages than when it was recorded");
        last_ = std::move(*frame);
        return {};
    }

    Result<void> picture(const view::RecordedPicture& message) {
        if (!last_) return Error{ErrorCode::invalid_input, "a recorded picture comes before its frame"};
        if (!target_ || target_->width() != last_->width || target_->height() != last_->height)
            target_.emplace(last_->width, last_->height);
        if (const auto drawn = painter_->draw(*last_, *target_); !drawn) differ(drawn.error().detail);
        ++report.drawn;
        if (message.has_hash()) compare(message.hash());
        wants_more_ = shown_(*target_, report.frames);
        return {};
    }

    void compare(std::uint64_t recorded) {
        ++report.hashed;
        const std::uint64_t hash = hash_of_picture(target_->read());
        if (hash == recorded) {
            ++report.equal;
            return;
        }
        char words[80];
        std::snprintf(words, sizeof words, "hash %016llx, recorded %016llx",
                      static_cast<unsigned long long>(hash), static_cast<unsigned long long>(recorded));
        differ(words);
    }

    Result<void> pattern(const view::HeldPattern& message) {
        if (message.forget_all()) {
            patterns_.clear();
            for (PlaneScene* scene : scenes()) scene->held_patterns().forget_patterns();
            return {};
        }
        const std::int64_t side = message.side();
        if (side < 1 || side > 256 || message.texels().size() != static_cast<std::size_t>(4 * side * side) ||
            !(message.side_texels() > 0))
            return Error{ErrorCode::invalid_input, "a recorded pattern is broken"};
        for (PlaneScene* scene : scenes()) show(message, *scene);
        if (patterns_.size() < HeldSprites::most_sprites) patterns_.push_back(message);
        return {};
    }
    static void show(const view::HeldPattern& message, PlaneScene& scene) {
        Rgba8Image image{message.side(), message.side()};
        std::copy(message.texels().begin(), message.texels().end(), image.bytes.begin());
        scene.held_patterns().set_pattern(message.pattern(), image, message.side_texels());
    }

    void differ(std::string what) {
        if (report.differences.size() < most_differences)
            report.differences.push_back({report.frames, std::move(what)});
    }

    std::vector<PlaneScene*> scenes() const {
        if (second_.scene) return {first_.scene.get(), second_.scene.get()};
        return {first_.scene.get()};
    }

    struct Played {
        std::unique_ptr<PlayedSource> source;  // the scene uses it
        std::unique_ptr<PlaneScene> scene;
        Result<void> make(Extent extent, const view::CacheSettings& message) {
            const auto settings = read_settings(message);
            if (!settings) return settings.error();
            scene.reset();
            source = std::make_unique<PlayedSource>();
            auto made = PlaneScene::make(extent, *source, *settings);
            if (!made) return made.error();
            scene = std::move(*made);
            return {};
        }
    };

    const std::function<bool(const FrameTarget&, std::uint64_t)>& shown_;
    Extent extent_{0};
    Played first_, second_;
    std::optional<ViewFrame> last_;
    std::vector<view::HeldPattern> patterns_;
    std::optional<FramePainter> painter_;
    std::optional<FrameTarget> target_;
    std::shared_ptr<const HeightImage> heights_;
    bool wants_more_ = true;
};

}  // namespace

Result<ReplayReport> replay(const std::filesystem::path& file,
                            const std::function<bool(const FrameTarget&, std::uint64_t frame)>& shown) {
    auto reader = SessionReader::open(file);
    if (!reader) return reader.error();
    Replay session{shown};
    view::SessionEntry entry;
    while (session.wants_more() && reader->next(entry)) {
        if (const auto taken = session.take(entry); !taken) {
            if (taken.error().code != ErrorCode::invalid_input) return taken.error();
            session.report.trouble = file.string() + ": " + taken.error().detail;
            return std::move(session.report);
        }
    }
    session.report.trouble = reader->trouble();
    return std::move(session.report);
}

std::string text_of(const ReplayReport& report) {
    std::string text = "tessera-view: replayed " + report.scene + ": " + std::to_string(report.frames) +
                       " frames, " + std::to_string(report.drawn) + " drawn, " +
                       std::to_string(report.equal) + " of " + std::to_string(report.hashed) +
                       " hashes equal";
    if (!report.end.empty()) text += "; the recording ended: " + report.end;
    text += '\n';
    for (const ReplayReport::Difference& difference : report.differences)
        text += "tessera-view: frame " + std::to_string(difference.frame) + ": " + difference.what + '\n';
    if (report.equal != report.hashed && report.recorded_with != gl_description())
        text += "tessera-view: recorded with " + report.recorded_with + ", replayed with " +
                gl_description() + ": drivers differ in their pixels\n";
    if (!report.trouble.empty()) text += "tessera-view: " + report.trouble + '\n';
    return text;
}

}  // namespace tessera
