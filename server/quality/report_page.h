#pragma once

#include <string>
#include <vector>

#include "server/quality/measures.h"
#include "server/quality/pictures.h"

namespace tessera {

/// A picture as a page holds it.
struct EmbeddedPicture {
    std::string address;  ///< data:image/…;base64,…
    std::int32_t width = 0, height = 0;
};
Result<EmbeddedPicture> embed_png(const Rgba8Image& image);
Result<EmbeddedPicture> embed_jpeg(const Rgba8Image& image);

/// All pictures of a report.
struct ReportPictures {
    struct Preview {
        int level = 0;
        EmbeddedPicture texture;
        EmbeddedPicture tile;  ///< To be repeated.
    };
    std::vector<Preview> previews;
    EmbeddedPicture tile, patches, seam_energy, tile_share, repeat_rate, mean_tile;
    std::int32_t greatest_coverage = 0;  ///< interchange: what `patches` shows at its brightest.
    std::vector<EmbeddedPicture> sheets;
};

/// The page: one file that asks nobody for anything.
std::string report_page(const std::string& title, const ExchangeAsset& asset, const Quality& quality,
                        const ContentSheets& contents, const ReportPictures& pictures);

/// Its looks and its few lines of script: report_style.cpp.
extern const char* const report_style;
extern const char* const report_script;

}  // namespace tessera
