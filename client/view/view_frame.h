#pragma once

#include <optional>
#include <vector>

#include "client/render/filter.h"
#include "client/render/held_map.h"
#include "client/render/plane_renderer.h"
#include "client/render/upload_budget.h"
#include "client/residency/plane_view.h"
#include "client/residency/residency.h"

namespace tessera {

/// The picture in two: what is right of a line is drawn otherwise.
struct SplitChoice {
    double at = 0.5;         ///< Where the line is: a share of the picture's width, 0 to 1.
    FilterChoice filter{};   ///< Of the right part.
    bool is_second = false;  ///< The right part's pages are the second source's: of another accuracy.
    bool operator==(const SplitChoice&) const = default;
};

/// All that decides one frame's picture, but for what its page source has brought by then: a session that is
/// recorded is a row of these with what came between them, and is drawn again from nothing else.
struct ViewFrame {
    Camera camera{};
    int width = 0;  ///< Pixels
    int height = 0;
    FrameTime time{ClientTime{0}};
    FilterChoice filter{};
    float fade_ms = 0;  ///< See PlaneStyle
    bool haze = true;   ///< See PlaneStyle
    Overlay overlay = Overlay::none;
    Surface surface{};
    std::optional<SplitChoice> split{};
    std::vector<HeldSprite> held{};  ///< What hands hold, drawn over the pages in this order …
    std::vector<PageHold> holds{};   ///< … until these show it.

    std::size_t most_uploads = UploadBudget::most_a_frame;  ///< Pages that may come in this frame

    /// The picture, and which pixels of it are sampled how.
    PlaneView view() const {
        const PlaneView whole{camera, width, height, surface};
        return split && !split->is_second ? whole.split_at(split_column(), sampling_of(split->filter))
                                          : whole;
    }
    /// The first pixel right of the split's line; the width where there is none.
    int split_column() const {
        if (!split) return width;
        const double column = split->at * width;
        return column < 1 ? 1 : column > width - 1 ? width - 1 : static_cast<int>(column);
    }
};

}  // namespace tessera
