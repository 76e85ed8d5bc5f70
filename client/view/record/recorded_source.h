#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "client/residency/page_source.h"

namespace tessera::view {
class SourceFrame;
}

namespace tessera {

/// Hands everything through, and remembers what it saw.
class RecordingSource final : public PageSource {
  public:
    /// `source` outlives this.
    explicit RecordingSource(PageSource& source);
    ~RecordingSource() override;

    bool request(const PageRequest& request) override;
    void cancel(PageRequestId id) override { source_.cancel(id); }
    std::vector<ArrivedPage> take_arrived(std::size_t most) override;
    void allow(std::size_t answers) override { source_.allow(answers); }
    void watch(std::span<const PageWindow> windows, std::uint64_t seen_revision) override {
        source_.watch(windows, seen_revision);
    }
    SceneNews take_news() override;

    /// All since the last call.
    view::SourceFrame take_frame();

  private:
    PageSource& source_;
    std::unique_ptr<view::SourceFrame> frame_;
    std::vector<std::uint64_t> asked_;
};

/// Says again what was recorded, frame by frame, whatever it is asked.
class PlayedSource final : public PageSource {
  public:
    PlayedSource();
    ~PlayedSource() override;

    /// From now on the calls of this frame are answered.
    void begin_frame(const view::SourceFrame& frame);
    /// Whether what was asked for in the frame is what was asked for when it was recorded.
    bool is_same() const;

    bool request(const PageRequest& request) override;
    void cancel(PageRequestId) override {}
    std::vector<ArrivedPage> take_arrived(std::size_t most) override;
    SceneNews take_news() override;

  private:
    std::unique_ptr<view::SourceFrame> frame_;
    std::vector<std::uint64_t> asked_;
    int next_news_ = 0, next_arrivals_ = 0, next_refused_ = 0;
};

}  // namespace tessera
