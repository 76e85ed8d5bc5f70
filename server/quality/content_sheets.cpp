#include <algorithm>
#include <array>
#include <cmath>

#include "server/quality/lab.h"
#include "server/quality/pictures.h"

namespace tessera {
namespace {

constexpr std::size_t most_contents = 8192;
constexpr std::int32_t thumbnails_a_row = 8, thumbnails_a_sheet = 64;
constexpr double most_thumbnail_texels = 6e6;  ///< Of all thumbnails: about three megabytes of JPEG.
constexpr std::int32_t around = 4;             ///< Texels of the tile shown around a content's box.

/// A content on the tile: what lies at a place relative to its box.
class ShownContent {
  public:
    ShownContent(const ExchangeAsset& asset, std::size_t patch, const ExchangeAsset::Content& content)
        : asset_{asset}, number_{patch}, patch_{asset.patches[patch]}, content_{content} {}

    bool covers(std::int32_t x, std::int32_t y) const {
        if (x < 0 || y < 0 || x >= patch_.width || y >= patch_.height) return false;
        if (content_.shape.width > 0) return content_.shape.at(x, y);
        // Without a shape it fills its patch
        const std::int32_t mask = asset_.tile_side - 1;
        return asset_.labels.empty() ||
               asset_.labels[std::size_t((patch_.y + y) & mask) * std::size_t(asset_.tile_side) +
                             std::size_t((patch_.x + x) & mask)] == number_;
    }
    const std::uint8_t* tile(std::int32_t x, std::int32_t y) const {
        const std::int32_t mask = asset_.tile_side - 1;
        return texel(asset_.tile, (patch_.x + x) & mask, (patch_.y + y) & mask);
    }
    /// Inside its shape.
    const std::uint8_t* content(std::int32_t x, std::int32_t y) const {
        return texel(asset_.exemplar, content_.at.x + x, content_.at.y + y);
    }

  private:
    static const std::uint8_t* texel(const Rgb8Image& image, std::int32_t x, std::int32_t y) {
        return image.bytes.data() + (std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * 3;
    }
    const ExchangeAsset& asset_;
    const std::size_t number_;
    const ExchangeAsset::Patch& patch_;
    const ExchangeAsset::Content& content_;
};

/// Its size, and its steps to the tile around.
void measure(const ShownContent& shown, const ExchangeAsset::Patch& patch, double exemplar_step,
             ContentFacts& facts) {
    double sum = 0, steps = 0;
    for (std::int32_t y = 0; y < patch.height; ++y)
        for (std::int32_t x = 0; x < patch.width; ++x) {
            if (!shown.covers(x, y)) continue;
            ++facts.texels;
            for (const auto& [dx, dy] :
                 {std::array{1, 0}, std::array{-1, 0}, std::array{0, 1}, std::array{0, -1}}) {
                if (shown.covers(x + dx, y + dy)) continue;
                sum += double(difference(shown.content(x, y), shown.tile(x + dx, y + dy)));
                ++steps;
            }
        }
    facts.seam_ratio = steps > 0 ? sum / steps / std::max(exemplar_step, 0.01) : 0;
}

void draw(const ShownContent& shown, const ExchangeAsset::Patch& patch, std::int32_t side, Rgba8Image& sheet,
          std::int32_t left, std::int32_t top) {
    // The box and a little around it, fitted into the square; a thumbnail's texel averages up to 4×4 places
    const double extent = std::max(patch.width, patch.height) + 2 * around;
    const double step = extent / side;
    const int places = std::clamp(static_cast<int>(std::lround(step)), 1, 4);
    const double first_x = (patch.width - extent) / 2, first_y = (patch.height - extent) / 2;
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            std::array<double, 3> sum{};
            for (int j = 0; j < places; ++j)
                for (int i = 0; i < places; ++i) {
                    const auto u =
                        static_cast<std::int32_t>(std::floor(first_x + (x + (i + 0.5) / places) * step));
                    const auto v =
                        static_cast<std::int32_t>(std::floor(first_y + (y + (j + 0.5) / places) * step));
                    const bool inside = shown.covers(u, v);
                    const std::uint8_t* codes = inside ? shown.content(u, v) : shown.tile(u, v);
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += inside ? codes[c] : 0.35 * codes[c];
                }
            std::uint8_t* out = sheet.row(top + y) + std::ptrdiff_t{4} * (left + x);
            for (std::size_t c = 0; c < 3; ++c)
                out[c] = static_cast<std::uint8_t>(std::lround(sum[c] / (places * places)));
            out[3] = 255;
        }
}

}  // namespace

Result<ContentSheets> draw_contents(const ExchangeAsset& asset, double exemplar_step,
                                    const ProgressPart& progress) {
    ContentSheets out;
    std::size_t all = 0;
    for (const auto& patch : asset.patches) all += patch.contents.size();
    const std::size_t count = std::min(all, most_contents);
    out.left_out = all - count;
    out.thumbnail_side = std::clamp(static_cast<std::int32_t>(std::sqrt(
                                        most_thumbnail_texels / double(std::max<std::size_t>(count, 1)))) /
                                        4 * 4,
                                    24, 112);
    const std::int32_t side = out.thumbnail_side;

    for (std::size_t p = 0; p < asset.patches.size(); ++p)
        for (std::size_t c = 0; c < asset.patches[p].contents.size() && out.contents.size() < count; ++c) {
            if (progress.progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
            const auto place = static_cast<std::int32_t>(out.contents.size() % thumbnails_a_sheet);
            if (place == 0) {
                progress.advance(double(out.contents.size()) / double(count));
                const auto left = std::min<std::size_t>(count - out.contents.size(), thumbnails_a_sheet);
                const auto rows = static_cast<std::int32_t>((left + thumbnails_a_row - 1) / thumbnails_a_row);
                out.sheets.emplace_back(side * thumbnails_a_row, side * rows);
            }
            const auto& patch = asset.patches[p];
            const ShownContent shown{asset, p, patch.contents[c]};
            ContentFacts facts;
            facts.patch = p;
            facts.content = c + 1;
            facts.sheet = out.sheets.size() - 1;
            facts.x = place % thumbnails_a_row * side;
            facts.y = place / thumbnails_a_row * side;
            measure(shown, patch, exemplar_step, facts);
            draw(shown, patch, side, out.sheets.back(), facts.x, facts.y);
            out.contents.push_back(facts);
        }
    progress.advance(1);
    return out;
}

}  // namespace tessera
