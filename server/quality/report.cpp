#include "server/quality/report.h"

#include <array>
#include <string>
#include <string_view>

#include <unistd.h>

#include "server/files/whole_file.h"
#include "server/quality/pictures.h"
#include "server/quality/report_json.h"
#include "server/quality/report_page.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t preview_side = 2048;
constexpr std::array preview_levels{0, 3, 6};
/// A repeated picture of few texels would be scaled to less than one.
constexpr std::int32_t least_repeat_side = 256;

/// A neighbour of `file` that is renamed into its place when both files of the report are there.
fs::path partial_of(const fs::path& file) {
    fs::path made = file;
    made.replace_filename("." + file.filename().string() + ".partial-" + std::to_string(::getpid()));
    return made;
}

Result<void> write_text(const fs::path& file, std::string_view text) {
    return write_whole_file(file, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

Result<void> rename_into_place(const fs::path& made, const fs::path& file) {
    std::error_code failure;
    fs::rename(made, file, failure);
    if (failure) return Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
    return {};
}

/// Both files, or neither is touched.
Result<void> write_both(const fs::path& html, std::string_view page, std::string_view json) {
    fs::path data = html;
    data.replace_extension(".json");
    const fs::path made_page = partial_of(html), made_data = partial_of(data);
    Result<void> done = write_text(made_data, json);
    if (done) done = write_text(made_page, page);
    if (done) done = rename_into_place(made_data, data);
    if (done) done = rename_into_place(made_page, html);
    std::error_code ignored;
    fs::remove(made_page, ignored);
    fs::remove(made_data, ignored);
    return done;
}

Result<ReportPictures> draw_pictures(const ExchangeAsset& asset, const Quality& quality,
                                     const ContentSheets& contents, const ExchangeTexture& texture,
                                     const ProgressPart& progress) {
    ReportPictures out;
    Error wrong;
    // Keeps the first error for the end
    const auto keep = [&](EmbeddedPicture& place, Result<EmbeddedPicture> picture) {
        if (picture)
            place = std::move(*picture);
        else
            wrong = picture.error();
        return picture.has_value();
    };
    for (const int level : preview_levels) {
        progress.advance(0.2 * double(out.previews.size()));
        auto& preview = out.previews.emplace_back();
        preview.level = level;
        Rgba8Image texels;
        const TexelRegion region{static_cast<std::uint8_t>(level), 0, 0, preview_side, preview_side};
        if (auto done = texture.evaluate(region, progress.budget(), texels); !done) return done.error();
        if (!keep(preview.texture, embed_jpeg(texels)) ||
            !keep(preview.tile, embed_png(tile_at_level(asset.tile, level, least_repeat_side))))
            return wrong;
    }
    progress.advance(0.6);
    if (asset.method == ExchangeMethod::content_exchange &&
        !keep(out.patches, embed_png(draw_patch_map(asset))))
        return wrong;
    if (asset.method == ExchangeMethod::interchange) {
        const Coverage coverage = draw_coverage(asset);
        out.greatest_coverage = coverage.greatest;
        if (!keep(out.patches, embed_png(coverage.image))) return wrong;
    }
    const std::int32_t cells = quality.share.cells_a_side;
    if (!keep(out.tile, embed_png(tile_at_level(asset.tile, 0))) ||
        !keep(out.seam_energy, embed_jpeg(draw_seam_energy(asset, quality.seams))) ||
        !keep(out.mean_tile, embed_png(draw_mean_tile(quality.repetition))) ||
        !keep(out.tile_share, embed_png(draw_cells(quality.share.tile, cells))) ||
        !keep(out.repeat_rate, embed_png(draw_cells(quality.share.repeat, cells))))
        return wrong;
    for (const Rgba8Image& sheet : contents.sheets)
        if (!keep(out.sheets.emplace_back(), embed_jpeg(sheet))) return wrong;
    progress.advance(1);
    return out;
}

}  // namespace

Result<void> check_report_target(const fs::path& html) {
    const std::string extension = html.extension().string();
    if (extension != ".html" && extension != ".htm")
        return Error{ErrorCode::invalid_input, html.string() + ": a report's name ends in .html"};
    std::error_code failure;
    if (fs::is_directory(html, failure))
        return Error{ErrorCode::invalid_input, html.string() + ": is a folder; name a file in it"};
    const fs::path parent = html.has_parent_path() ? html.parent_path() : fs::path{"."};
    if (!fs::is_directory(parent, failure))
        return Error{ErrorCode::io_failure, parent.string() + ": is not a folder; make it first"};
    return {};
}

Result<void> write_report(const fs::path& html, const ExchangeAsset& asset, Progress& progress) {
    if (auto may = check_report_target(html); !may) return may;
    progress.advance("measuring", 0);
    return write_report(html, asset, textures_of(asset), progress);
}

Result<void> write_report(const fs::path& html, const ExchangeAsset& asset, const MeasuredTextures& textures,
                          Progress& progress) {
    if (auto may = check_report_target(html); !may) return may;
    const auto failed = [&](const Error& error) -> Result<void> {
        if (error.code == ErrorCode::cancelled)
            return Error{ErrorCode::cancelled, html.string() + ": stopped; nothing of it was written"};
        return Error{error.code, html.string() + ": " + error.detail};
    };
    const auto quality = measure_quality(asset, textures, {progress, "measuring"});
    if (!quality) return failed(quality.error());
    const ProgressPart drawing{progress, "drawing"};
    const auto contents = draw_contents(asset, quality->seams.exemplar.mean, drawing.part(0, 0.4));
    if (!contents) return failed(contents.error());
    const auto pictures = draw_pictures(asset, *quality, *contents, *textures.blended, drawing.part(0.4, 1));
    if (!pictures) return failed(pictures.error());
    return write_both(html, report_page(html.stem().string(), asset, *quality, *contents, *pictures),
                      report_json(asset, *quality, *contents));
}

}  // namespace tessera
