#pragma once

#include <memory>

#include "client/view/view_frame.h"

namespace tessera::view {
class CacheSettings;
class HeightField;
class RecordedFrame;
}  // namespace tessera::view

namespace tessera {

/// What decides a frame's picture, as session.proto has it; not the heights of its terrain.
void write_frame(const ViewFrame& frame, view::RecordedFrame& message);
/// `heights`: those that were recorded last; null: none. Error: invalid_input, naming the field.
Result<ViewFrame> read_frame(const view::RecordedFrame& message,
                             const std::shared_ptr<const HeightImage>& heights);

void write_settings(const ResidencySettings& settings, view::CacheSettings& message);
/// Error: invalid_input, naming the field.
Result<ResidencySettings> read_settings(const view::CacheSettings& message);

void write_heights(const HeightImage& heights, view::HeightField& message);
/// Error: invalid_input.
Result<std::shared_ptr<const HeightImage>> read_heights(const view::HeightField& message);

}  // namespace tessera
