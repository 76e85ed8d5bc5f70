#include "server/accuracy/report_rows.h"

namespace tessera {

void add_rows(const View& view, const std::string& texture, const GroundTruth& truth,
              const std::vector<FilterMeasurement>& measured, const PictureNames& names,
              proto::AccuracyReport& report) {
    std::vector<double> times, errors;
    for (const FilterMeasurement& one : measured) {
        times.push_back(one.nanoseconds_per_sample);
        errors.push_back(one.error.mse);
    }
    const std::vector<bool> front = pareto_front(times, errors);
    for (std::size_t i = 0; i < measured.size(); ++i) {
        const FilterMeasurement& one = measured[i];
        proto::AccuracyRow& row = *report.add_rows();
        row.set_situation(std::string{view.situation.name});
        row.set_texture(texture);
        row.set_filter(one.name);
        row.set_where(on_cpu);
        row.set_mse(one.error.mse);
        row.set_psnr(one.error.psnr);
        row.set_ms_ssim(one.error.ms_ssim);
        row.set_max_error(one.error.max_error);
        row.set_texels_per_sample(one.texels_per_sample);
        row.set_nanoseconds_per_sample(one.nanoseconds_per_sample);
        row.set_truth_mse(truth.mse);
        row.set_pareto(front[i]);
        row.set_mse_linear(one.mse_linear);
        row.set_bound_codes(one.bound_codes);
        row.set_pixels(static_cast<std::uint32_t>(one.pixels));
        row.set_beyond_bound(one.beyond_bound);
        if (names.stem.empty() || one.picture.codes.empty()) continue;
        row.set_picture(names.result(one.name));
        row.set_error_picture(names.error(one.name));
        row.set_count_picture(names.texels(one.name));
    }
}

}  // namespace tessera
