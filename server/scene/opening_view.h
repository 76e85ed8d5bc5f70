#pragma once

#include "shared/page/opening_view.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

namespace proto {
class OpeningView;
}

/// What a scene file says, with its defaults. Error: invalid_input; the message starts with the field
/// ("view.x: …").
Result<OpeningView> opening_view_of(const proto::OpeningView& message, Extent extent);

}  // namespace tessera
