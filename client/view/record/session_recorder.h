#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "client/view/record/recorded_source.h"
#include "client/view/record/session_file.h"
#include "client/view/view_frame.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// Writes down a session while it is shown: each frame, and what its sources of pages said in it. Where that
/// cannot go on (the file's limit, a slow disk), it ends, says so in problem(), and what was written is good.
class SessionRecorder {
  public:
    /// `most_bytes`: of the file, a frame more or less. Error: io_failure.
    static Result<std::unique_ptr<SessionRecorder>> open(const std::filesystem::path& file,
                                                         std::uint64_t most_bytes);
    ~SessionRecorder();  ///< Writes the end.

    /// Once, before all others. Returns the source that the scene is to be made with in place of this one.
    /// Needs a current context.
    PageSource& begin(const std::string& scene, Extent extent, PageSource& source,
                      const ResidencySettings& settings);
    /// The same for a second scene, until end_second().
    PageSource& begin_second(PageSource& source, const ResidencySettings& settings);
    void end_second();

    /// After each FramePainter::update().
    void frame(const ViewFrame& frame);
    /// The last frame was drawn. `hash`: of the picture (hash_of_picture), if it was read.
    void picture(std::optional<std::uint64_t> hash);
    /// As HeldSprites::set_pattern() and forget_patterns().
    void pattern(std::int32_t pattern, const Rgba8Image& image, double side_texels);
    void forget_patterns();
    void resize(std::size_t slots);

    /// Why it has ended before the session did; empty: it has not.
    const std::string& problem() const { return problem_; }

  private:
    SessionRecorder(std::unique_ptr<SessionWriter> writer, std::uint64_t most_bytes);
    void add(const view::SessionEntry& entry);
    void end(const std::string& reason);

    std::unique_ptr<SessionWriter> writer_;
    std::uint64_t most_bytes_;
    std::unique_ptr<RecordingSource> source_, second_;
    std::shared_ptr<const HeightImage> heights_;
    std::uint64_t frames_ = 0;
    bool has_ended_ = false;
    std::string problem_;
};

/// XXH64 of its RGBA bytes: what hashes of frames are.
std::uint64_t hash_of_picture(const Rgba8Image& image);

}  // namespace tessera
