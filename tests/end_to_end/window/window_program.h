#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "client/residency/camera.h"
#include "client/residency/surface.h"
#include "client/view/hand_view.h"
#include "tests/end_to_end/view/program.h"
#include "tests/end_to_end/window/x_screen.h"
#include "tests/support/temporary_folder.h"

namespace tessera::proto {
class SceneEditables;
class SpriteList;
}  // namespace tessera::proto

namespace tessera::test {

/// A window on a scene, `meadow`, that has all that can be edited: sprites of 8 texels, maps, an animation, a
/// target. A pixel is a quarter of a texel; straight down at (720, 720).
class WindowOnMeadow : public ::testing::Test {
  protected:
    static constexpr int width = 800, height = 640;
    static constexpr double middle = 720;

    WindowOnMeadow();

    /// Opens it, and waits until it draws. `more`: on the command line.
    void open(const std::vector<std::string>& more = {}, int dots_per_inch = 96,
              const std::string& size = "800x640");

    struct Pixel {
        double x = 0, y = 0;
    };
    /// Of the window, where the camera has not been moved; the texel is seen.
    Pixel pixel_of(double texel_x, double texel_y) const;
    void click(double texel_x, double texel_y);
    void drag(double x0, double y0, double x1, double y1);
    /// The middles of what is filled with this colour (0xRRGGBB) in a row of the window at least so many
    /// pixels long, from the left; `from_below`: the first such row from there.
    std::vector<Pixel> runs_of(std::uint32_t colour, int least_pixels) const;

    // ---- What became of it
    std::uint64_t revision() const;
    proto::SpriteList sprites() const;
    proto::SceneEditables editables() const;
    /// The bytes of the page at level 0 around the middle, at step 0.
    std::string page() const;
    /// The camera, as K prints it: yaw and so on by name.
    double camera(const std::string& what);
    /// What the server has told has been heard, and is shown.
    void let_frames_pass();
    static bool until(const std::function<bool()>& holds);

    tests::TemporaryFolder files;
    std::unique_ptr<testing::Program> server;
    std::unique_ptr<XScreen> screen;
    std::unique_ptr<testing::Program> viewer;
    Camera looks;
    Surface surface;  ///< Which `open` is told to show.

  private:
    std::string get(const std::string& target) const;
    std::uint16_t port_ = 0;
};

}  // namespace tessera::test
