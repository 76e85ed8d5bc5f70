#pragma once

#include <string>

#include "client/residency/slot.h"
#include "shared/page/page_key.h"

namespace tessera {

/// Texels to put into a slot, before the next picture is drawn.
struct SlotUpload {
    Slot slot = 0;
    PageKey page;
    std::string texels;  ///< slot_bytes; see ArrivedPage
};

}  // namespace tessera
