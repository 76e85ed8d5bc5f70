#include "server/accuracy/accuracy_run.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "server/accuracy/claims.h"
#include "server/accuracy/gpu_rows.h"
#include "server/accuracy/machine.h"
#include "server/accuracy/page_comparisons.h"
#include "server/accuracy/report_rows.h"
#include "server/accuracy/stability_curves.h"
#include "server/accuracy/view_pictures.h"
#include "server/files/whole_file.h"
#include "server/filter/texel_pages.h"
#include "server/prepare/prepare.h"
#include "server/scenes/paint_pebbles.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t page_cache_bytes = std::size_t{256} << 20;

/// A preparation's own stages are parts of "textures".
class PreparingProgress final : public Progress {
  public:
    explicit PreparingProgress(Progress& outer) : outer_{outer} {}
    void advance(std::string_view, double) override {}
    void note(const std::string& sentence) override { outer_.note(sentence); }
    std::stop_token stop() const override { return outer_.stop(); }

  private:
    Progress& outer_;
};

/// Of several parts of a stage: what the current one reports.
struct StagePart {
    Progress& progress;
    std::string_view stage;
    std::size_t index = 0, count = 1;
    void operator()(double fraction) const {
        progress.advance(stage, (static_cast<double>(index) + fraction) / static_cast<double>(count));
    }
};

std::shared_ptr<const TexelPages> pages_of(const MeasuredTexture& texture) {
    return texture.image ? pages_of_image(*texture.image, Beyond::repeat)
                         : pages_of_texture(texture.texture, Accuracy::exact, page_cache_bytes);
}

/// What stands for all settings where pages are evaluated rather than stored, and each costs milliseconds.
constexpr std::array<std::string_view, 15> scene_filters{"nearest",
                                                         "bilinear",
                                                         "trilinear",
                                                         "summed-area",
                                                         "anisotropic-4",
                                                         "anisotropic-16",
                                                         "ewa",
                                                         "line-integral-4",
                                                         "line-integral-8",
                                                         "line-integral-16",
                                                         "line-integral-48",
                                                         "line-integral-vertical-16",
                                                         "line-integral-horizontal-16",
                                                         "supersampling-jittered-8x8",
                                                         "exact"};

std::vector<MeasuredFilter> filters_on(const std::shared_ptr<const TexelPages>& pages, bool all) {
    std::vector<MeasuredFilter> filters;
    for (const FootprintFilter& filter : compared_filters())
        if (const std::string name = name_of(filter); all || std::ranges::count(scene_filters, name) > 0)
            filters.push_back({name, [filter, pages] { return make_sampler(filter, pages); }});
    return filters;
}

/// What every filter makes of one colour: the claim that none changes it.
Result<double> worst_on_constant(const AccuracyOptions& options) {
    const MeasuredTexture constant = constant_texture();
    double worst = 0;
    for (Situation& situation : situations(64, 56)) {
        const View view = view_of(std::move(situation));
        const auto truth =
            ground_truth(view, constant.truth(), 0, 1, options.measure.budget.cancelled, [](double) {});
        if (!truth) return truth.error();
        MeasureOptions quick = options.measure;
        quick.rounds = 0;
        const auto measured =
            measure_filters(view, *truth, filters_on(pages_of(constant), true), quick, [](double) {});
        if (!measured) return measured.error();
        for (const FilterMeasurement& one : *measured) worst = std::max(worst, one.worst_linear);
    }
    return worst;
}

Result<void> measure_texture(const MeasuredTexture& texture, const std::vector<View>& views,
                             std::size_t index, std::size_t count, const AccuracyOptions& options,
                             const fs::path& pictures, Progress& progress, proto::AccuracyReport& report) {
    const bool stored = texture.image != nullptr;
    const auto filters = filters_on(pages_of(texture), stored || options.every_filter_on_scenes);
    MeasureOptions measure = options.measure;
    if (!stored) measure.picture_seconds = options.scene_picture_seconds;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const View& view = views[v];
        const StagePart truth_part{progress, "truth and filters", 2 * (index * views.size() + v),
                                   2 * count * views.size()};
        const auto truth =
            ground_truth(view, texture.truth(), stored ? options.truth_samples : options.scene_truth_samples,
                         options.threads, progress.stop(), truth_part);
        if (!truth) return Error{truth.error().code, texture.name + ": " + truth.error().detail};
        StagePart filter_part = truth_part;
        ++filter_part.index;
        const auto measured = measure_filters(view, *truth, filters, measure, filter_part);
        if (!measured) return Error{measured.error().code, texture.name + ": " + measured.error().detail};
        const PictureNames names = options.pictures ? PictureNames{view, texture.name} : PictureNames{};
        add_rows(view, texture.name, *truth, *measured, names, report);
        if (!options.pictures) continue;
        const auto written =
            write_view_pictures(pictures, names, view, *truth, *measured, options.threads, progress.stop());
        if (!written) return written;
    }
    return {};
}

Result<void> compare_pages(const AccuracyOptions& options, const fs::path& workshop, Progress& progress,
                           proto::AccuracyReport& report) {
    std::vector<proto::PageRow> rows;
    const auto step = [&](int done) { progress.advance("pages", done / 6.0); };
    const auto stopped = [&]() -> Result<void> {
        if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
        return {};
    };
    step(0);
    const MeasuredTexture photograph = photograph_texture(progress.stop()), checker = checker_texture(),
                          text = text_texture();
    if (auto done = stopped(); !done) return done;
    for (const MeasuredTexture* texture : {&photograph, &checker, &text})
        compare_light(texture->name, *texture->image, rows);
    step(1);
    compare_content_depth(photograph.name, *photograph.image, rows);
    LinearImage dark = *photograph.image;
    for (float& value : dark.values) value /= 32;
    compare_content_depth("a dark photograph", dark, rows);
    if (auto done = stopped(); !done) return done;
    step(2);
    compare_integrals(rows);
    step(3);
    PreparingProgress preparing{progress};
    PrepareOptions small;
    small.tile_side = 64;
    small.threads = options.threads;
    const auto asset = prepare_exchange(paint_pebbles(256, 3, progress.stop()), small, nullptr, preparing);
    if (!asset) return asset.error();
    step(4);
    if (auto done = compare_statistics(asset->asset, progress.stop(), rows); !done) return done;
    step(5);
    const auto layers = painted_scene("leaves", workshop);
    if (!layers) return layers.error();
    if (auto done = compare_descents(layers->title, *layers->texture, progress.stop(), rows); !done)
        return done;
    step(6);
    for (proto::PageRow& row : rows) *report.add_pages() = std::move(row);
    for (proto::StabilityCurve& curve : stability_curves(options.most_column_log2))
        *report.add_curves() = std::move(curve);
    return stopped();
}

}  // namespace

std::vector<TerminalProgress::Share> accuracy_shares() {
    return {{"textures", 0.05}, {"truth and filters", 0.85}, {"pages", 0.1}};
}

Result<std::vector<MeasuredTexture>> measured_textures(const AccuracyOptions& options,
                                                       const fs::path& workshop, Progress& progress) {
    std::vector<std::string> names = options.textures;
    if (names.empty()) names.assign(built_in_texture_names().begin(), built_in_texture_names().end());
    std::vector<MeasuredTexture> textures;
    std::set<std::string> taken;
    for (std::size_t i = 0; i < names.size(); ++i) {
        progress.advance("textures", static_cast<double>(i) / static_cast<double>(names.size()));
        PreparingProgress preparing{progress};
        auto texture = std::ranges::count(built_in_texture_names(), names[i]) > 0
                           ? built_in_texture(names[i], workshop, preparing)
                           : read_texture(names[i], options.limits);
        if (!texture) return texture.error();
        // Two files of one name are told apart by a number
        const std::string name = texture->name;
        for (int number = 2; !taken.insert(texture->name).second; ++number)
            texture->name = name + "-" + std::to_string(number);
        textures.push_back(std::move(*texture));
        if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
    }
    progress.advance("textures", 1);
    return textures;
}

Result<proto::AccuracyReport> run_accuracy(const AccuracyOptions& options, const fs::path& folder,
                                           Progress& progress) {
    const RemovedAtEnd workshop{folder / "workshop"};
    std::error_code failure;
    fs::create_directories(workshop.folder, failure);
    if (!failure) fs::create_directories(folder / "pictures", failure);
    if (failure) return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message()};

    proto::AccuracyReport report;
    report.set_machine(machine_words(options.threads));
    report.set_made_by(options.made_by);
    // What is read from files first: who named a wrong one is not kept waiting
    proto::AccuracyReport gpu;
    if (!options.gpu_rows.empty()) {
        auto read = read_gpu_rows(options.gpu_rows);
        if (!read) return read.error();
        gpu = std::move(*read);
    }
    const auto textures = measured_textures(options, workshop.folder, progress);
    if (!textures) return textures.error();

    std::vector<View> views;
    for (Situation& situation : situations(options.width, options.height))
        views.push_back(view_of(std::move(situation)));
    for (std::size_t i = 0; i < textures->size(); ++i) {
        const auto done = measure_texture((*textures)[i], views, i, textures->size(), options,
                                          folder / "pictures", progress, report);
        if (!done) return done.error();
    }
    const auto constant = worst_on_constant(options);
    if (!constant) return constant.error();
    if (options.pages)
        if (const auto done = compare_pages(options, workshop.folder, progress, report); !done)
            return done.error();
    if (!options.gpu_rows.empty())
        if (const auto done = add_gpu_rows(std::move(gpu), options.gpu_rows, folder / "pictures", report);
            !done)
            return done.error();
    add_claims({.worst_on_constant = *constant, .width = options.width, .height = options.height}, report);
    return report;
}

}  // namespace tessera
