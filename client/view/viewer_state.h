#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "client/render/filter.h"
#include "client/render/plane_renderer.h"
#include "client/residency/residency.h"
#include "client/view/camera_control.h"
#include "client/view/view_frame.h"
#include "shared/page/accuracy.h"

namespace tessera {

/// Of pages; every driver has 2048 layers, and some are stand-ins'.
inline constexpr int least_cache_pages = 64, most_cache_pages = 2016;

/// What the hands can switch.
struct ViewerSwitches {
    bool panel = true;
    bool help = false;
    bool metrics = false;  ///< The session's figures
    Surface surface{};
    Overlay overlay = Overlay::none;
    std::optional<SplitChoice> split{};
    Accuracy accuracy = Accuracy::high;         ///< Of the pages; not to be switched
    Accuracy split_accuracy = Accuracy::exact;  ///< Of the right part, where `split` has pages of its own
    bool orbits = false;  ///< A drag goes around the middle of the picture, instead of moving the plane
    bool haze = true;
    bool fade = true;
    bool vsync = true;
    FilterChoice filter{};
    std::size_t cache_pages = 0;  ///< From now on; of each part, where a picture has pages of its own in both
};

/// The next surface (or the last, with `steps` −1), as it stands around this camera.
Surface surface_after(const Surface& surface, int steps, const Camera& camera);

/// Splits the picture: the right part by the next filter; or makes it whole.
void switch_split(ViewerSwitches& switches);

/// The next filter (or the last, with `steps` −1) of those that this driver has.
Filter filter_after(Filter filter, int steps, bool has_driver_anisotropy);

/// "16x anisotropic, by the formula": for people.
const char* title_of(Filter filter);

/// The last frames' times.
class FrameTimes {
  public:
    void add(double milliseconds) {
        times_[count_ % times_.size()] = static_cast<float>(milliseconds);
        ++count_;
    }
    const std::array<float, 120>& values() const { return times_; }
    int oldest() const { return static_cast<int>(count_ % times_.size()); }
    double mean_milliseconds() const {
        const std::size_t known = count_ < times_.size() ? count_ : times_.size();
        double sum = 0;
        for (std::size_t i = 0; i < known; ++i) sum += static_cast<double>(times_[i]);
        return known == 0 ? 0 : sum / static_cast<double>(known);
    }

  private:
    std::array<float, 120> times_{};
    std::size_t count_ = 0;
};

/// What lies under the cursor.
struct CursorReading {
    PlanePoint texel{};
    double level = 0;  ///< As filtered: fractional, 0 to n
    PageKey page;      ///< Of the nearest level
    std::optional<ShownPage> shown;
    bool under_way = false;
    std::optional<PageVersion> version{};  ///< Of the page that is shown
};

/// Nothing if the cursor is on the sky or beyond the extent.
std::optional<CursorReading> read_cursor(const PlaneView& view, const Residency& residency, double lod_bias,
                                         double x, double y);

/// "sharp", "2 levels coarser, on its way", …
std::string page_state(const CursorReading& reading);

}  // namespace tessera
