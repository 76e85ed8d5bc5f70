#pragma once

#include <stop_token>
#include <string>
#include <string_view>

namespace tessera {

/// What a long preparation tells whoever waits for it. Every call may come from any thread.
class Progress {
  public:
    Progress() = default;
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    virtual ~Progress() = default;

    /// `fraction` of `stage` is done, 0 to 1.
    virtual void advance(std::string_view stage, double fraction) = 0;
    /// Something was decided that the asker did not ask for: one sentence.
    virtual void note(const std::string& sentence) = 0;
    /// Stops the preparation soon: it returns ErrorCode::cancelled.
    virtual std::stop_token stop() const { return {}; }
};

/// Says nothing.
class SilentProgress final : public Progress {
  public:
    void advance(std::string_view, double) override {}
    void note(const std::string&) override {}
};

}  // namespace tessera
