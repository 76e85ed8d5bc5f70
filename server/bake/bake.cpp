#include "server/bake/bake.h"

#include <algorithm>
#include <bit>
#include <vector>

#include <OpenImageIO/imageio.h>

#include "server/pages/evaluate_within.h"
#include "server/pages/page_encoder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t band_rows = 64;            ///< As many rows as a tile of a .tx has.
constexpr std::int32_t widest_evaluation = 4096;  ///< What Texture::evaluate takes.

Error refused(const fs::path& file, const std::string& why) {
    return {ErrorCode::invalid_input, file.string() + ": " + why};
}

/// One band of a level as wide as the file, in the file's texels.
class Band {
  public:
    Band(const Texture& texture, std::optional<ErrorLimit> limit, const Budget& budget, bool linear)
        : texture_{texture}, limit_{limit}, budget_{budget}, linear_{linear} {}

    /// Evaluates `region`, piece by piece where it is wide.
    Result<void> fill(const TexelRegion& region, bool straight_alpha) {
        bytes_.resize(linear_ ? 0 : std::size_t(region.width) * std::size_t(region.height) * 4);
        floats_.resize(linear_ ? std::size_t(region.width) * std::size_t(region.height) * 4 : 0);
        for (std::int32_t x = 0; x < region.width; x += widest_evaluation) {
            TexelRegion part = region;
            part.x += x;
            part.width = std::min(widest_evaluation, region.width - x);
            const auto copy = [&](const auto& row_of, auto& whole) {
                for (std::int32_t y = 0; y < region.height; ++y)
                    std::copy_n(row_of(y), part.width * 4,
                                whole.begin() + (std::ptrdiff_t(y) * region.width + x) * 4);
            };
            if (linear_) {
                LinearImage texels;
                if (auto done = evaluate(part, texels); !done) return done;
                copy([&](std::int32_t y) { return texels.row(y); }, floats_);
            } else {
                Rgba8Image texels;
                if (auto done = evaluate(part, texels); !done) return done;
                if (straight_alpha) texels = to_straight_alpha(texels);
                copy([&](std::int32_t y) { return texels.row(y); }, bytes_);
            }
        }
        return {};
    }

    OIIO::TypeDesc type() const { return linear_ ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8; }
    const Baked& baked() const { return baked_; }
    const void* data() const { return linear_ ? static_cast<const void*>(floats_.data()) : bytes_.data(); }

  private:
    template <class Image>
    Result<void> evaluate(const TexelRegion& part, Image& texels) {
        const auto done = evaluate_within(texture_, part, limit_, budget_, texels);
        if (!done) return done.error();
        baked_.bound_codes = std::max(baked_.bound_codes, done->evaluation.bound_codes);
        baked_.confidence = std::min(baked_.confidence, done->evaluation.confidence);
        baked_.within_limit = baked_.within_limit && done->met;
        return {};
    }

    const Texture& texture_;
    std::optional<ErrorLimit> limit_;
    Baked baked_;
    const Budget& budget_;
    bool linear_;
    std::vector<std::uint8_t> bytes_;
    std::vector<float> floats_;
};

OIIO::ImageSpec spec_for(const fs::path& ending, TexelKind kind, std::int32_t width, std::int32_t height) {
    const bool linear = ending == ".exr", tiled = ending == ".tx";
    OIIO::ImageSpec spec{width, height, 4, linear ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::UINT8};
    spec.attribute("oiio:ColorSpace", kind == TexelKind::data ? "Raw" : linear ? "Linear" : "sRGB");
    if (ending == ".png") spec.attribute("oiio:UnassociatedAlpha", 1);
    if (tiled) {
        spec.tile_width = spec.tile_height = band_rows;
        spec.tile_depth = 1;
        spec.attribute("compression", "zip");
        spec.attribute("textureformat", "Plain Texture");
        spec.attribute("wrapmodes", "black,black");
    }
    return spec;
}

/// Writes one image, which is `region` of its level, band by band.
Result<void> write_level(OIIO::ImageOutput& out, const fs::path& file, const TexelRegion& region, Band& band,
                         const std::function<void(std::int64_t)>& rows_done) {
    const bool tiled = file.extension() == ".tx", straight = file.extension() == ".png";
    for (std::int32_t y = 0; y < region.height; y += band_rows) {
        TexelRegion rows = region;
        rows.y += y;
        rows.height = std::min(band_rows, region.height - y);
        if (auto filled = band.fill(rows, straight); !filled) return filled;
        const bool written =
            tiled ? out.write_tiles(0, region.width, y, y + rows.height, 0, 1, band.type(), band.data())
                  : out.write_scanlines(y, y + rows.height, 0, band.type(), band.data());
        if (!written) return Error{ErrorCode::io_failure, file.string() + ": " + out.geterror()};
        rows_done(rows.height);
    }
    return {};
}

Result<void> check(const TexelRegion& region, const fs::path& file) {
    const fs::path ending = file.extension();
    if (ending != ".png" && ending != ".exr" && ending != ".tx")
        return refused(file, "what it should hold is told by its ending: .png, .exr or .tx");
    if (region.width < 1 || region.height < 1 || std::max(region.width, region.height) > max_bake_side)
        return refused(file, "sides are 1 to " + std::to_string(max_bake_side) +
                                 " texels; bake a coarser level or in parts");
    if (ending != ".tx") return {};
    const bool square =
        region.width == region.height && std::has_single_bit(static_cast<std::uint32_t>(region.width));
    if (!square || region.x % region.width != 0 || region.y % region.width != 0)
        return refused(
            file,
            "MIP levels share their texels' corners only if the region is a square of 2^k texels at a "
            "multiple of its side, such as 4096,8192,4096,4096");
    if (region.level + std::countr_zero(static_cast<std::uint32_t>(region.width)) > max_level)
        return refused(file, "its coarsest MIP level would lie above level 30; start from a finer level");
    return {};
}

}  // namespace

Result<Baked> bake(const Texture& texture, const TexelRegion& region, std::optional<ErrorLimit> limit,
                   const Budget& budget, const fs::path& file, const std::function<void(double)>& progress) {
    if (auto good = check(region, file); !good) return good.error();
    fs::path partial = file;
    partial.replace_filename("." + file.stem().string() + ".partial" + file.extension().string());
    const auto out = OIIO::ImageOutput::create(partial.string());
    if (!out) return Error{ErrorCode::io_failure, file.string() + ": " + OIIO::geterror()};

    const auto write = [&]() -> Result<Baked> {
        Band band{texture, limit, budget, file.extension() == ".exr"};
        const bool mip = file.extension() == ".tx";
        std::int64_t done = 0;
        const double all = double(region.height) * (mip ? 2 : 1);
        for (TexelRegion level = region;;
             ++level.level, level.x /= 2, level.y /= 2, level.width /= 2, level.height /= 2) {
            // TIFF keeps MIP levels as further images; readers of textures know them by "textureformat"
            const auto mode = level == region ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendSubimage;
            if (!out->open(partial.string(),
                           spec_for(file.extension(), texture.texel_kind(), level.width, level.height), mode))
                return Error{ErrorCode::io_failure, file.string() + ": " + out->geterror()};
            const auto rows_done = [&](std::int64_t rows) {
                done += rows;
                progress(std::min(1.0, double(done) / all));
            };
            if (auto written = write_level(*out, file, level, band, rows_done); !written)
                return written.error();
            if (!mip || level.width == 1) break;
        }
        if (!out->close()) return Error{ErrorCode::io_failure, file.string() + ": " + out->geterror()};
        std::error_code failure;
        fs::rename(partial, file, failure);
        if (failure) return Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
        return band.baked();
    };
    const auto written = write();
    if (!written) {
        out->close();
        std::error_code ignored;
        fs::remove(partial, ignored);
    }
    return written;
}

}  // namespace tessera
