#include "client/view/frame_painter.h"

namespace tessera {

ResidencyFrame FramePainter::update(const ViewFrame& frame) {
    return scene_.update(frame.view(), frame.time, frame.filter);
}

Result<void> FramePainter::draw(const ViewFrame& frame, const FrameTarget& target) {
    return scene_.draw(target, frame.view(),
                       {.filter = frame.filter,
                        .fade_ms = frame.fade_ms,
                        .haze = frame.haze,
                        .page_borders = frame.page_borders});
}

}  // namespace tessera
