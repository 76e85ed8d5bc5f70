#pragma once

#include <string>

#include "proto/accuracy.pb.h"

namespace tessera {

/// index.html: the report as a page that works offline. Style, script and figures are inside; pictures are
/// the files beside it.
std::string report_page(const proto::AccuracyReport& report);

}  // namespace tessera
