#include "client/view/record/session_recorder.h"

#include <xxhash.h>

#include "client/render/gl_context.h"
#include "client/view/record/frame_message.h"
#include "client/view/record/session.pb.h"

namespace tessera {

Result<std::unique_ptr<SessionRecorder>> SessionRecorder::open(const std::filesystem::path& file,
                                                               std::uint64_t most_bytes) {
    auto writer = SessionWriter::open(file);
    if (!writer) return writer.error();
    return std::unique_ptr<SessionRecorder>{new SessionRecorder{std::move(*writer), most_bytes}};
}

SessionRecorder::SessionRecorder(std::unique_ptr<SessionWriter> writer, std::uint64_t most_bytes)
    : writer_{std::move(writer)}, most_bytes_{most_bytes} {}

SessionRecorder::~SessionRecorder() { end("closed"); }

PageSource& SessionRecorder::begin(const std::string& scene, Extent extent, PageSource& source,
                                   const ResidencySettings& settings) {
    view::SessionEntry entry;
    view::SessionHead& head = *entry.mutable_head();
    head.set_program("tessera-view " TESSERA_VERSION);
    head.set_scene(scene);
    head.set_extent_n(extent.n);
    write_settings(settings, *head.mutable_cache());
    head.set_renderer(gl_description());
    add(entry);
    source_ = std::make_unique<RecordingSource>(source);
    return *source_;
}

PageSource& SessionRecorder::begin_second(PageSource& source, const ResidencySettings& settings) {
    view::SessionEntry entry;
    write_settings(settings, *entry.mutable_second());
    add(entry);
    second_ = std::make_unique<RecordingSource>(source);
    return *second_;
}

void SessionRecorder::end_second() {
    view::SessionEntry entry;
    entry.set_end_second(true);
    add(entry);
    second_.reset();
}

void SessionRecorder::frame(const ViewFrame& frame) {
    view::SessionEntry entry;
    if (frame.surface.heights && frame.surface.heights != heights_) {
        heights_ = frame.surface.heights;
        write_heights(*heights_, *entry.mutable_heights());
        add(entry);
    }
    view::RecordedFrame& message = *entry.mutable_frame();
    write_frame(frame, message);
    *message.add_sources() = source_->take_frame();
    if (second_) *message.add_sources() = second_->take_frame();
    if (has_ended_) return;
    ++frames_;
    add(entry);
    if (writer_->bytes() > most_bytes_) {
        problem_ = "the limit of " + std::to_string(most_bytes_ / 1'000'000) + " MB is reached";
        end(problem_);
    }
}

void SessionRecorder::picture(std::optional<std::uint64_t> hash) {
    view::SessionEntry entry;
    view::RecordedPicture& message = *entry.mutable_picture();
    if (hash) message.set_hash(*hash);
    add(entry);
}

void SessionRecorder::pattern(std::int32_t pattern, const Rgba8Image& image, double side_texels) {
    view::SessionEntry entry;
    view::HeldPattern& message = *entry.mutable_pattern();
    message.set_pattern(pattern);
    message.set_side(image.width);
    message.set_texels(std::string{image.bytes.begin(), image.bytes.end()});
    message.set_side_texels(side_texels);
    add(entry);
}

void SessionRecorder::forget_patterns() {
    view::SessionEntry entry;
    entry.mutable_pattern()->set_forget_all(true);
    add(entry);
}

void SessionRecorder::resize(std::size_t slots) {
    view::SessionEntry entry;
    entry.set_resize_slots(slots);
    add(entry);
}

void SessionRecorder::add(const view::SessionEntry& entry) {
    if (has_ended_ || writer_->add(entry)) return;
    has_ended_ = true;
    problem_ = writer_->problem();
}

void SessionRecorder::end(const std::string& reason) {
    view::SessionEntry entry;
    entry.mutable_end()->set_reason(reason);
    entry.mutable_end()->set_frames(frames_);
    add(entry);
    has_ended_ = true;
}

std::uint64_t hash_of_picture(const Rgba8Image& image) {
    return XXH64(image.bytes.data(), image.bytes.size(), 0);
}

}  // namespace tessera
