#include "client/render/filter.h"

#include <epoxy/gl.h>

namespace tessera {

bool has_driver_anisotropy() {
    return epoxy_gl_version() >= 46 || epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic") ||
           epoxy_has_gl_extension("GL_ARB_texture_filter_anisotropic");
}

}  // namespace tessera
