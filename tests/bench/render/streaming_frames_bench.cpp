// What a frame costs while 200 pages a second stream in, 60 frames a second at 800x700: blocks of frames with
// and without news, by turns, so that other work on the machine meets both. Times are the process's CPU time,
// of all threads. After each block all pages have to be the newest and the GPU has to hold what was brought,
// or nothing is printed. A last part brings as many pages as there is room for: then the upload budget
// decides.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "client/render/page_identity.h"
#include "tests/simulation/simulated_stream.h"
#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace {

using namespace tessera;
using testing::SimulatedStream;

constexpr int width = 800, height = 700, frames_a_block = 30, pages_a_second = 200;

[[noreturn]] void refuse(const std::string& why) {
    std::fprintf(stderr, "streaming_frames_bench: %s\n", why.c_str());
    std::exit(1);
}

double cpu_milliseconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Painting is the server's work: a few pages are painted once.
std::string page_of(PageKey page, std::uint32_t, std::uint64_t revision) {
    static std::vector<std::string> painted;
    for (std::uint32_t i = static_cast<std::uint32_t>(painted.size()); i < 16; ++i)
        painted.push_back(testing::paint_page({3, i, i}, testing::noise_texel));
    return painted[(page.x + page.y + revision) % painted.size()];
}

struct Times {
    std::vector<double> frames, uploads;
    std::size_t pages = 0, most_pages = 0;
    double at(double share) const {
        std::vector<double> sorted = frames;
        std::ranges::sort(sorted);
        return sorted[std::min(sorted.size() - 1,
                               static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
    }
};

class Bench {
  public:
    explicit Bench(FilterChoice filter) : filter_{filter} {
        auto made = PlaneScene::make(Extent{20}, stream_, {.slots = 400});
        if (!made) refuse(made.error().detail);
        scene_ = std::move(*made);
        settle();
    }

    /// `pages_a_frame`: this many of what is in view are edited in each frame.
    void block(Times& times, double pages_a_frame) {
        double due = 0;
        for (int frame = 0; frame < frames_a_block; ++frame) {
            due += pages_a_frame;
            std::vector<PageKey> edited;
            for (; due >= 1 && !sampled_.empty(); --due)
                edited.push_back(sampled_[next_++ % sampled_.size()].key);
            if (!edited.empty()) stream_.edit(edited);
            step(&times);
        }
        settle();
    }

  private:
    bool step(Times* times) {
        now_ += ClientTime{16};
        stream_.advance(now_);
        const PlaneView view{camera_, width, height};
        scene_->set_uploads_per_frame(scene_->upload_budget().pages());
        const double begin = cpu_milliseconds();
        ResidencyFrame frame = scene_->update(view, now_, filter_);
        if (const auto drawn = scene_->draw(target_, view, {.filter = filter_}); !drawn)
            refuse(drawn.error().detail);
        glFinish();
        const double took = cpu_milliseconds() - begin;
        identity_.add(frame);
        if (times) {
            times->frames.push_back(took);
            times->uploads.push_back(scene_->upload_ms());
            times->pages += frame.uploads.size();
            times->most_pages = std::max(times->most_pages, frame.uploads.size());
        }
        sampled_ = std::move(frame.sampled);
        return frame.is_current();
    }
    void settle() {
        for (int frames = 0; !step(nullptr); ++frames)
            if (frames > 2000) refuse("the newest pages do not come");
        const auto checked = identity_.check(*scene_, sampled_, sampled_.size());
        if (checked.wrong > 0 || checked.pixels == 0) refuse("the GPU holds other pages than were brought");
    }

    FilterChoice filter_;
    std::unique_ptr<GlContext> context_ = testing::headless_context();
    SimulatedStream stream_{{}, page_of};
    FrameTarget target_{width, height};
    std::unique_ptr<PlaneScene> scene_;
    PageIdentity identity_;
    Camera camera_{
        .ground = {134'217'728, 134'217'728, 0.5, 0.5}, .height_texels = 512, .pitch_degrees = -40};
    ClientTime now_{};
    std::vector<NeededPage> sampled_;
    std::size_t next_ = 0;
};

void print(const char* name, const Times& times, double quiet_median) {
    const auto late = std::ranges::count_if(times.frames, [&](double ms) { return ms > 2 * quiet_median; });
    std::printf("%-26s %7zu %6zu %8zu %8.2f %8.2f %8.2f %8.2f %9.2f %7td\n", name, times.frames.size(),
                times.pages, times.most_pages, times.at(0.5), times.at(0.95), times.at(0.99),
                std::ranges::max(times.frames), std::ranges::max(times.uploads), late);
}

}  // namespace

int main(int argc, char** argv) {
    const int blocks = argc > 1 ? std::max(std::atoi(argv[1]), 1) : 6;
    std::printf(
        "%dx%d, CPU ms a frame (deciding, uploading, drawing); late: more than twice the median without "
        "news\n",
        width, height);
    std::printf("%-26s %7s %6s %8s %8s %8s %8s %8s %9s %7s\n", "", "frames", "pages", "most", "p50", "p95",
                "p99", "worst", "upload ms", "late");
    try {
        for (const Filter filter : {Filter::trilinear, Filter::line_integral}) {
            Bench bench{{.filter = filter}};
            Times quiet, streaming, flood;
            for (int block = 0; block < blocks; ++block) {
                bench.block(quiet, 0);
                bench.block(streaming, pages_a_second / 60.0);
            }
            bench.block(flood, 40);
            const std::string name{name_of(filter)};
            print((name + ", no news").c_str(), quiet, quiet.at(0.5));
            print((name + ", 200 pages/s").c_str(), streaming, quiet.at(0.5));
            print((name + ", a flood").c_str(), flood, quiet.at(0.5));
            std::fflush(stdout);
        }
    } catch (const std::exception& error) {
        refuse(error.what());
    }
}
