#pragma once

#include <string>

#include "server/quality/measures.h"
#include "server/quality/pictures.h"

namespace tessera {

/// All figures, for programs: numbers with six significant digits, one object a figure.
std::string report_json(const ExchangeAsset& asset, const Quality& quality, const ContentSheets& contents);

}  // namespace tessera
