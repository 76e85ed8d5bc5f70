#include "client/render/shader_source.h"

#include <initializer_list>

#include "anisotropic_glsl.h"
#include "constants_vert.h"
#include "filter_glsl.h"
#include "held_sprites_glsl.h"
#include "isotropic_glsl.h"
#include "line_integral_glsl.h"
#include "pages_glsl.h"
#include "picture_vert.h"
#include "plane_frag.h"
#include "shading_glsl.h"
#include "situation_frag.h"
#include "sky_frag.h"
#include "source_glsl.h"
#include "supersample_glsl.h"
#include "surface_frag.h"
#include "surface_vert.h"
#include "view_glsl.h"
#include "whole_glsl.h"

namespace tessera {
namespace {

constexpr const char* version = "#version 450 core\n";

/// The names that filter.glsl compares.
const char* define_of(Filter filter) {
    switch (filter) {
        case Filter::nearest:
            return "NEAREST";
        case Filter::bilinear:
            return "BILINEAR";
        case Filter::driver_anisotropic:
            return "DRIVER_ANISOTROPIC";
        case Filter::anisotropic:
            return "ANISOTROPIC";
        case Filter::line_integral:
            return "LINE_INTEGRAL";
        case Filter::supersample:
            return "SUPERSAMPLE";
        case Filter::trilinear:
        case Filter::stored:
            break;
    }
    return "TRILINEAR";
}

std::string definitions(const ShaderVariant& variant) {
    std::string text =
        "#define NEAREST 1\n#define BILINEAR 2\n#define TRILINEAR 3\n#define ANISOTROPIC 4\n"
        "#define DRIVER_ANISOTROPIC 5\n#define LINE_INTEGRAL 6\n#define SUPERSAMPLE 7\n";
    text += "#define FILTER " + std::string{define_of(variant.filter.filter)} + '\n';
    if (variant.filter.filter == Filter::supersample)
        text += "#define SUBSAMPLES " + std::to_string(variant.filter.subsamples) + '\n';
    if (variant.filter.filter == Filter::stored) text += "#define STORED_TEXELS\n";
    if (variant.whole) text += "#define WHOLE\n";
    if (variant.fading) text += "#define FADING\n";
    if (variant.overlay != Overlay::none)
        text += "#define OVERLAY " + std::to_string(static_cast<int>(variant.overlay)) + '\n';
    if (variant.count_fetches) text += "#define COUNT_FETCHES\n";
    if (variant.few_probes) text += "#define FEW_PROBES\n";
    if (variant.feedback) text += "#define FEEDBACK\n";
    if (variant.held_sprites) text += "#define HELD_SPRITES\n";
    return text;
}

const char* filter_file(Filter filter) {
    switch (filter) {
        case Filter::driver_anisotropic:
        case Filter::anisotropic:
            return anisotropic_glsl_source;
        case Filter::line_integral:
            return line_integral_glsl_source;
        case Filter::supersample:
            return supersample_glsl_source;
        default:
            return "";
    }
}

}  // namespace

std::string fragment_source(const ShaderVariant& variant) {
    if (variant.picture == ShaderVariant::Picture::sky)
        return std::string{version} + view_glsl_source + sky_frag_source;
    std::string text = version + definitions(variant);
    const bool situation = variant.picture == ShaderVariant::Picture::situation;
    for (const char* part :
         {source_glsl_source, variant.whole ? whole_glsl_source : pages_glsl_source, isotropic_glsl_source,
          filter_file(variant.filter.filter), variant.held_sprites ? held_sprites_glsl_source : "",
          filter_glsl_source, situation ? "" : view_glsl_source, situation ? "" : shading_glsl_source,
          variant.picture == ShaderVariant::Picture::plane     ? plane_frag_source
          : variant.picture == ShaderVariant::Picture::surface ? surface_frag_source
                                                               : situation_frag_source})
        text += part;
    return text;
}

std::string vertex_source(const ShaderVariant& variant) {
    const std::string text = std::string{version} + "#define VERTEX\n" + constants_vert_source;
    if (variant.picture != ShaderVariant::Picture::surface) return text + picture_vert_source;
    return text + view_glsl_source + surface_vert_source;
}

}  // namespace tessera
