#include "client/view/path_recorder.h"

namespace tessera {
namespace {

constexpr double seconds_between_keys = 0.1;
constexpr std::size_t most_keys = 36'000;  // an hour

}  // namespace

std::optional<Camera> PathRecorder::advance(double seconds, const Camera& camera) {
    if (is_recording_) {
        seconds_ += seconds;
        const bool is_due = noted_.empty() || seconds_ >= noted_.back().seconds + seconds_between_keys;
        // A rest is one key at its begin and one at its end
        const std::size_t count = noted_.size();
        const bool rests =
            count >= 2 && noted_[count - 1].camera == camera && noted_[count - 2].camera == camera;
        if (is_due && rests)
            noted_.back().seconds = seconds_;
        else if (is_due && count < most_keys)
            noted_.push_back({seconds_, camera});
    }
    if (!playing_) return std::nullopt;
    played_ += seconds;
    const Camera at = playing_->at(playing_->begin_seconds() + played_);
    if (playing_->begin_seconds() + played_ >= playing_->end_seconds()) playing_.reset();
    return at;
}

void PathRecorder::start_recording() {
    is_recording_ = true;
    seconds_ = 0;
    noted_.clear();
}

std::string PathRecorder::stop_recording() {
    is_recording_ = false;
    std::string keys;
    for (const Noted& key : noted_)
        keys += (keys.empty() ? "  " : ",\n  ") + camera_key_json(key.seconds, key.camera);
    return keys.empty() ? keys : "{\"keys\": [\n" + keys + "\n]}\n";
}

void PathRecorder::play(const CameraPath& path) {
    playing_ = path;
    played_ = 0;
}

}  // namespace tessera
