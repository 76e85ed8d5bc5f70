#include "client/view/compare_filters.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "client/render/gl_context.h"
#include "client/render/situation_renderer.h"
#include "client/view/area_truth.h"
#include "client/view/compare_pictures.h"
#include "client/view/compare_report.h"
#include "client/view/png_file.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

/// One filter in one situation on one texture.
struct Outcome {
    FilterChoice filter;
    FloatPicture picture;  ///< With the texels read in alpha
    std::vector<double> milliseconds;
};

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values.empty() ? 0 : values[values.size() / 2];
}

class Comparison {
  public:
    Comparison(const CompareJob& job, const std::function<void(const std::string&)>& progress)
        : job_{job},
          progress_{progress},
          renderer_{job.width, job.height},
          filters_{compared_filters()},
          renderer_name_{gl_description()} {}

    Result<proto::AccuracyReport> run() {
        report_.set_machine(renderer_name_);
        report_.set_made_by(job_.command);
        for (const CompareTexture& texture : job_.textures) {
            WholeTexture whole{averaged_levels(texture.image)};
            if (const auto there = whole.bring_integrals(); !there) return there.error();
            const AreaTruth truth{texture.image};
            for (const Situation& situation : situations(job_.width, job_.height))
                if (const auto done = compare(situation, texture, whole, truth); !done) return done.error();
        }
        judge(report_);
        return std::move(report_);
    }

  private:
    Result<void> compare(const Situation& situation, const CompareTexture& texture, const WholeTexture& whole,
                         const AreaTruth& truth) {
        const std::string about = std::string{situation.name} + ", " + texture.name;
        progress_(about + ": the truth");
        const TruePicture expected = true_picture(situation, truth);
        std::vector<Outcome> outcomes;
        for (const FilterChoice& filter : filters_) {
            progress_(about + ": " + label_of(filter));
            if (const auto drawn = renderer_.draw(situation, whole, filter, true); !drawn)
                return drawn.error();
            outcomes.push_back({filter, renderer_.read(), {}});
        }
        progress_(about + ": frame times");
        for (int round = 0; round <= job_.rounds; ++round) {
            for (Outcome& outcome : outcomes) {
                // Some software drivers take seconds: once is enough
                if (outcome.filter.filter == Filter::driver_anisotropic && round > 1) continue;
                const auto started = Clock::now();
                if (const auto drawn = renderer_.draw(situation, whole, outcome.filter); !drawn)
                    return drawn.error();
                renderer_.finish();
                const auto took = std::chrono::duration<double, std::milli>(Clock::now() - started);
                if (round > 0) outcome.milliseconds.push_back(took.count());  // the first one compiles
            }
        }
        progress_(about + ": errors and pictures");
        return write(situation, texture, expected, outcomes);
    }

    Result<void> write(const Situation& situation, const CompareTexture& texture, const TruePicture& expected,
                       const std::vector<Outcome>& outcomes) {
        const auto reference = std::ranges::find(
            outcomes, Filter::anisotropic, [](const Outcome& outcome) { return outcome.filter.filter; });
        const std::string stem = std::string{situation.name} + '_' + texture.name;
        const Rgba8Image truth = shown(expected.codes, expected.measured);
        if (const auto written = write_png(job_.folder / (stem + "_truth.png"), truth); !written)
            return written.error();
        std::vector<std::vector<Rgba8Image>> parts;
        for (const Outcome& outcome : outcomes) {
            const CodeImage codes = codes_of(outcome.picture);
            const ImageError error = image_error(expected.codes, codes, expected.measured);
            // The driver does not tell how many texels it reads
            const bool is_counted = outcome.filter.filter != Filter::driver_anisotropic;
            const std::string file = stem + '_' + label_of(outcome.filter);
            const Rgba8Image pictures[] = {shown(codes, expected.measured),
                                           difference(expected.codes, codes, expected.measured),
                                           texel_map(is_counted ? outcome.picture : reference->picture,
                                                     reference->picture, expected.measured)};
            const std::string names[] = {file + ".png", file + "_error.png",
                                         is_counted ? file + "_texels.png" : ""};
            for (std::size_t i = 0; i < (is_counted ? 3 : 2); ++i)
                if (const auto written = write_png(job_.folder / names[i], pictures[i]); !written)
                    return written.error();
            add_row(situation, texture, expected, outcome, error, names);
            if (is_on_sheet(outcome.filter)) {
                parts.emplace_back();
                for (const Rgba8Image& picture : pictures) parts.back().push_back(part_of(picture));
            }
        }
        const Rgba8Image nothing = part_of(difference(expected.codes, expected.codes, expected.measured));
        parts.insert(parts.begin(), {part_of(truth), nothing, nothing});
        return write_png(job_.folder / ("sheet_" + stem + ".png"), sheet(parts));
    }

    void add_row(const Situation& situation, const CompareTexture& texture, const TruePicture& expected,
                 const Outcome& outcome, const ImageError& error, const std::string (&names)[3]) {
        proto::AccuracyRow& row = *report_.add_rows();
        row.set_situation(std::string{situation.name});
        row.set_texture(texture.name);
        row.set_filter(label_of(outcome.filter));
        row.set_where(renderer_name_);
        row.set_mse(error.mse);
        row.set_psnr(error.psnr);
        row.set_ms_ssim(error.ms_ssim);
        row.set_max_error(error.max_error);
        double texels = 0, squares = 0, measured = 0;
        for (std::size_t at = 0; at < expected.measured.size(); ++at) {
            if (!expected.measured[at]) continue;
            ++measured;
            texels += static_cast<double>(outcome.picture.values[4 * at + 3]);
            for (std::size_t c = 0; c < 3; ++c) {
                const double off = 255 * static_cast<double>(outcome.picture.values[4 * at + c] -
                                                             expected.linear[3 * at + c]);
                squares += off * off;
            }
        }
        if (measured > 0) {
            row.set_texels_per_sample(texels / measured);
            row.set_mse_linear(squares / (3 * measured));
        }
        row.set_frame_milliseconds(median(outcome.milliseconds));
        row.set_frame_milliseconds_best(*std::ranges::min_element(outcome.milliseconds));
        row.set_nanoseconds_per_sample(row.frame_milliseconds() * 1e6 / (job_.width * job_.height));
        row.set_picture(names[0]);
        row.set_error_picture(names[1]);
        row.set_count_picture(names[2]);
    }

    static bool is_on_sheet(const FilterChoice& filter) {
        return filter.filter != Filter::nearest &&
               (filter.filter != Filter::line_integral || filter.columns == 8) &&
               (filter.filter != Filter::supersample || filter.subsamples == 4);
    }

    /// Of the picture's middle, where footprints are long
    Rgba8Image part_of(const Rgba8Image& picture) const {
        const int width = std::min(200, job_.width), height = std::min(160, job_.height);
        const int top = std::min(job_.height * 2 / 5, job_.height - height);
        return cut(picture, (job_.width - width) / 2, top, width, height);
    }

    const CompareJob& job_;
    const std::function<void(const std::string&)>& progress_;
    SituationRenderer renderer_;
    std::vector<FilterChoice> filters_;
    std::string renderer_name_;
    proto::AccuracyReport report_;
};

}  // namespace

std::vector<FilterChoice> compared_filters() {
    std::vector<FilterChoice> choices;
    for (const Filter filter : filters) {
        if (filter == Filter::driver_anisotropic && !has_driver_anisotropy()) continue;
        if (filter == Filter::line_integral) {
            for (const int columns : {2, 4, 6, 8, 12, 24})
                choices.push_back({.filter = filter, .columns = columns});
        } else if (filter == Filter::supersample) {
            for (const int subsamples : {2, 4, 8})
                choices.push_back({.filter = filter, .subsamples = subsamples});
        } else {
            choices.push_back({.filter = filter});
        }
    }
    return choices;
}

std::string label_of(const FilterChoice& filter) {
    std::string label{name_of(filter.filter)};
    if (filter.filter == Filter::line_integral) label += '-' + std::to_string(filter.columns);
    if (filter.filter == Filter::supersample)
        label += '-' + std::to_string(filter.subsamples) + 'x' + std::to_string(filter.subsamples);
    return label;
}

Result<proto::AccuracyReport> compare_filters(const CompareJob& job,
                                              const std::function<void(const std::string&)>& progress) {
    std::error_code failed;
    std::filesystem::create_directories(job.folder, failed);
    if (failed)
        return Error{ErrorCode::io_failure, job.folder.string() + ": cannot be made: " + failed.message()};
    auto report = Comparison{job, progress}.run();
    if (!report) return report.error();
    if (const auto written = write_report(job.folder, *report); !written) return written.error();
    return report;
}

}  // namespace tessera
