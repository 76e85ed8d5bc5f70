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
        if (scenes_.empty())
            return Error{ErrorCode::invalid_input, "the recording does not begin with a head"};
        if (entry.has_frame()) return frame(entry.frame());
        if (entry.has_heights()) {
            auto heights = read_heights(entry.heights());
            if (!heights) return heights.error();
            heights_ = std::move(*heights);
        } else if (entry.has_pattern()) {
            return pattern(entry.pattern());
        } else if (entry.entry_case() == view::SessionEntry::kResizeSlots) {
            for (const auto& scene : scenes_)
                if (const auto done = scene->resize(entry.resize_slots()); !done) return done.error();
        } else if (entry.has_end()) {
            report.end = entry.end().reason();
        }
        return {};
    }
    bool wants_more() const { return wants_more_; }

    ReplayReport report;

  private:
    Result<void> begin(const view::SessionHead& head) {
        if (!scenes_.empty() || head.caches().empty() || head.caches_size() > 2 ||
            head.extent_n() > max_level)
            return Error{ErrorCode::invalid_input, "the recording's head is broken"};
        report.scene = head.scene();
        report.recorded_by = head.program();
        report.recorded_with = head.renderer();
        extent_ = Extent{static_cast<std::uint8_t>(head.extent_n())};
        for (const view::CacheSettings& message : head.caches()) {
            const auto settings = read_settings(message);
            if (!settings) return settings.error();
            auto scene = PlaneScene::make(extent_, *sources_.emplace_back(std::make_unique<PlayedSource>()),
                                          *settings);
            if (!scene) return scene.error();
            scenes_.push_back(std::move(*scene));
        }
        painter_.emplace(*scenes_[0], scenes_.size() > 1 ? scenes_[1].get() : nullptr);
        return {};
    }

    Result<void> frame(const view::RecordedFrame& message) {
        const auto frame = read_frame(message, heights_);
        if (!frame) return frame.error();
        const PlanePoint& at = frame->camera.ground;
        if (at.x < 0 || at.y < 0 || at.x >= extent_.side_texels() || at.y >= extent_.side_texels())
            return Error{ErrorCode::invalid_input, "a recorded camera lies outside the extent"};
        if (message.sources_size() != static_cast<int>(sources_.size()))
            return Error{ErrorCode::invalid_input, "a recorded frame lacks what a source of pages said"};
        for (std::size_t i = 0; i < sources_.size(); ++i)
            sources_[i]->begin_frame(message.sources(static_cast<int>(i)));
        painter_->update(*frame);
        for (const auto& source : sources_)
            if (!source->is_same()) differ("asks for other pages than when it was recorded");
        if (message.drawn() && !draw(*frame, message)) wants_more_ = false;
        ++report.frames;
        return {};
    }

    bool draw(const ViewFrame& frame, const view::RecordedFrame& message) {
        if (!target_ || target_->width() != frame.width || target_->height() != frame.height)
            target_.emplace(frame.width, frame.height);
        if (const auto drawn = painter_->draw(frame, *target_); !drawn) differ(drawn.error().detail);
        ++report.drawn;
        if (message.has_hash()) {
            ++report.hashed;
            const std::uint64_t hash = hash_of_picture(target_->read());
            if (hash == message.hash()) {
                ++report.equal;
            } else {
                char words[80];
                std::snprintf(words, sizeof words, "hash %016llx, recorded %016llx",
                              static_cast<unsigned long long>(hash),
                              static_cast<unsigned long long>(message.hash()));
                differ(words);
            }
        }
        return shown_(*target_, report.frames);
    }

    Result<void> pattern(const view::HeldPattern& message) {
        if (message.forget_all()) {
            for (const auto& scene : scenes_) scene->held_patterns().forget_patterns();
            return {};
        }
        const std::int64_t side = message.side();
        if (side < 1 || side > 256 || message.texels().size() != static_cast<std::size_t>(4 * side * side) ||
            !(message.side_texels() > 0))
            return Error{ErrorCode::invalid_input, "a recorded pattern is broken"};
        Rgba8Image image{message.side(), message.side()};
        std::copy(message.texels().begin(), message.texels().end(), image.bytes.begin());
        for (const auto& scene : scenes_)
            scene->held_patterns().set_pattern(message.pattern(), image, message.side_texels());
        return {};
    }

    void differ(std::string what) {
        if (report.differences.size() < most_differences)
            report.differences.push_back({report.frames, std::move(what)});
    }

    const std::function<bool(const FrameTarget&, std::uint64_t)>& shown_;
    Extent extent_{0};
    std::vector<std::unique_ptr<PlayedSource>> sources_;  // the scenes use them
    std::vector<std::unique_ptr<PlaneScene>> scenes_;
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
