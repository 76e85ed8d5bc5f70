#pragma once

#include <string_view>

namespace tessera {

/// The report's page as it stands in page/, in pieces that report_page() puts together.
extern const std::string_view page_html, page_style, page_script;

}  // namespace tessera
