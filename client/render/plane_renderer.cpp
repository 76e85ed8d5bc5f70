#include "client/render/plane_renderer.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

/// The uniform block `View` of shaders/view.glsl, in std140.
struct ViewBlock {
    float forward[4];
    float right[4];  ///< A pixel's width at depth 1; last: nothing is nearer than this
    float up[4];     ///< A pixel's height at depth 1
    float picture[2];
    float height;  ///< What haze is measured by
    float haze;    ///< 1, or 0 without
};
static_assert(sizeof(ViewBlock) == 64);

void put(float (&target)[4], const Vector3& v, double scale) {
    target[0] = static_cast<float>(v.x * scale);
    target[1] = static_cast<float>(v.y * scale);
    target[2] = static_cast<float>(v.z * scale);
    target[3] = 0;
}

constexpr double least_haze_height = 1500;  ///< Texels, of surfaces that are no plane

ViewBlock block_of(const PlaneView& view, bool haze) {
    ViewBlock block{};
    put(block.forward, view.forward(), 1);
    put(block.right, view.right(), 2 * view.tangent_x() / view.width());
    put(block.up, view.up(), 2 * view.tangent_y() / view.height());
    block.picture[0] = static_cast<float>(view.width());
    block.picture[1] = static_cast<float>(view.height());
    // Hills and walls near the eye are no fog
    const double height = view.camera().height_texels;
    block.height = static_cast<float>(view.is_plane() ? height : std::max(height, least_haze_height));
    block.right[3] = static_cast<float>(1e-3 * height);
    block.haze = haze ? 1 : 0;
    return block;
}

/// How many rows of pixels, from the picture's lower edge, have their middles below the horizon, which is
/// level.
int rows_of_plane(const PlaneView& view) {
    const double rise = view.tangent_y() * view.up().z;
    const double horizon = (1 - view.forward().z / rise) * view.height() / 2 - 0.5;
    return static_cast<int>(std::ceil(std::clamp(horizon, 0.0, static_cast<double>(view.height()))));
}

/// How many rows of the plane's, from the picture's lower edge, have no footprint longer than so many times
/// its width. Of a row, the outermost are the longest; and each row's are longer than those of the row below.
int rows_of_footprints(const PlaneView& view, int rows, double most) {
    const auto ratio = [&](double x, double y) {
        const double right = (2 * x / view.width() - 1) * view.tangent_x(),
                     up = (2 * y / view.height() - 1) * view.tangent_y();
        const auto along = [&](double Vector3::*axis) {
            return view.forward().*axis + right * view.right().*axis + up * view.up().*axis;
        };
        const double fall = -along(&Vector3::z), rise = view.up().z / fall;
        const double dy = std::hypot(view.up().x + rise * along(&Vector3::x),
                                     view.up().y + rise * along(&Vector3::y)) *
                          view.tangent_y() / view.height(),
                     dx = view.tangent_x() / view.width();
        return fall > 0 ? std::max(dx / dy, dy / dx) : 1e30;
    };
    int low = 0, high = rows;
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        const double y = middle - 0.5;
        if (std::max(ratio(0.5, y), ratio(view.width() - 0.5, y)) < most)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

ShaderVariant variant_of(const PlaneStyle& style, bool is_plane = true, bool held = false) {
    const bool stored = style.filter.filter == Filter::stored;
    return {.picture = is_plane ? ShaderVariant::Picture::plane : ShaderVariant::Picture::surface,
            .filter = style.filter,
            .fading = style.fade_ms > 0 && !stored,
            .overlay = stored ? Overlay::none : style.overlay,
            .held_sprites = held && !stored,
            .feedback = style.feedback};
}

}  // namespace

PlaneRenderer::PlaneRenderer(Extent extent) : extent_{extent}, pass_{sizeof(ViewBlock)} {}

Result<void> PlaneRenderer::prepare(const PlaneStyle& style) {
    if (const auto sky = pass_.prepare({.picture = ShaderVariant::Picture::sky}); !sky) return sky.error();
    return pass_.prepare(variant_of(style));
}

Result<void> PlaneRenderer::draw(const FrameTarget& target, const PlaneView& view,
                                 const TexelTextures& texels, int window_side, const PlaneStyle& style) {
    const ViewBlock block = block_of(view, style.haze);
    SourceBlock source;
    source.set_origin(view.camera().ground);
    source.set_extent(extent_, view.camera().ground);
    source.set_window(window_side);
    source.now_ms = style.now_ms;
    source.fade_ms = style.fade_ms;
    source.most_columns = static_cast<float>(style.filter.columns);
    source.set_bias(style.lod_bias);

    const bool stored = style.filter.filter == Filter::stored;
    const int first = std::clamp(style.first_column, 0, view.width()),
              columns = std::clamp(style.end_column, first, view.width()) - first;
    // A plane ends at the horizon; hills rise above it, and are drawn over the sky
    const int horizon = rows_of_plane(view);
    const int sky_from = view.is_plane() ? horizon : std::max(horizon - 2, 0),
              rows = view.is_plane() ? horizon : view.height();
    glEnable(GL_SCISSOR_TEST);
    Result<void> sky, surface;
    if (sky_from < view.height()) {
        target.bind();
        glScissor(first, sky_from, columns, view.height() - sky_from);
        if (stored) {
            constexpr float nothing[4] = {};
            glClearBufferfv(GL_COLOR, 0, nothing);
        } else {
            sky = pass_.draw({.picture = ShaderVariant::Picture::sky}, source,
                             std::as_bytes(std::span{&block, 1}), {});
        }
    }
    if (rows > 0) {
        if (stored)
            target.bind();
        else
            target.bind_linear();
        glScissor(first, 0, columns, rows);
        if (!view.is_plane()) geometry_.upload(view.pieces());
        if (!view.is_plane() && style.feedback) {
            // Only pixels that are seen tell what they read: depths come first
            PlaneStyle quiet = style;
            quiet.feedback = false;
            surface = pass_.draw(variant_of(quiet, false), source, std::as_bytes(std::span{&block, 1}),
                                 texels, &geometry_);
        }
        ShaderVariant variant = variant_of(style, view.is_plane(), texels.held != nullptr);
        // Near rows, whose footprints are short, have the simpler shader
        int simpler = 0;
        if (variant.filter.filter == Filter::anisotropic && view.is_plane() && !variant.fading &&
            !variant.feedback && style.lod_bias >= 0)
            simpler = rows_of_footprints(view, rows, 0.999 * most_few_probes);
        if (simpler > 0) {
            variant.few_probes = true;
            glScissor(first, 0, columns, simpler);
            surface = pass_.draw(variant, source, std::as_bytes(std::span{&block, 1}), texels);
            variant.few_probes = false;
            glScissor(first, simpler, columns, rows - simpler);
        }
        if (simpler < rows && surface)
            surface = pass_.draw(variant, source, std::as_bytes(std::span{&block, 1}), texels,
                                 view.is_plane() ? nullptr : &geometry_);
        glDisable(GL_FRAMEBUFFER_SRGB);
    }
    glDisable(GL_SCISSOR_TEST);
    return sky ? surface : sky;
}

}  // namespace tessera
