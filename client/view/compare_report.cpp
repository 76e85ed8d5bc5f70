#include "client/view/compare_report.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <vector>

#include "shared/wire/json.h"

namespace tessera {
namespace {

using proto::AccuracyRow;

bool are_alike(const AccuracyRow& a, const AccuracyRow& b) {
    return a.situation() == b.situation() && a.texture() == b.texture() && a.where() == b.where();
}

std::string text(const char* format, auto... values) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
}

void claim(proto::AccuracyReport& report, std::string words, bool holds, std::string figures) {
    proto::AccuracyClaim& made = *report.add_claims();
    made.set_text(std::move(words));
    made.set_holds(holds);
    made.set_figures(std::move(figures));
}

}  // namespace

void judge(proto::AccuracyReport& report) {
    for (AccuracyRow& row : *report.mutable_rows())
        row.set_pareto(std::ranges::none_of(report.rows(), [&](const AccuracyRow& other) {
            return are_alike(row, other) && other.mse() <= row.mse() &&
                   other.frame_milliseconds() <= row.frame_milliseconds() &&
                   (other.mse() < row.mse() || other.frame_milliseconds() < row.frame_milliseconds());
        }));
    for (const AccuracyRow& reference : report.rows()) {
        if (reference.filter() != "anisotropic-16") continue;
        const AccuracyRow* best = nullptr;
        for (const AccuracyRow& row : report.rows())
            if (are_alike(row, reference) && row.filter().starts_with("line-integral") &&
                row.texels_per_sample() <= 64 && (!best || row.mse() < best->mse()))
                best = &row;
        if (!best) continue;
        const std::string where = reference.situation() + ", " + reference.texture() + ": ";
        const std::string figures =
            text("%.3f with %.1f texels (%s) against %.3f with %.1f texels: %.2f times", best->mse(),
                 best->texels_per_sample(), best->filter().c_str(), reference.mse(),
                 reference.texels_per_sample(), best->mse() / reference.mse());
        claim(report, where + "line integrals with at most 64 texels err less than 16x anisotropic",
              best->mse() < reference.mse(), figures);
        claim(report,
              where + "line integrals with at most 64 texels err at most a quarter of 16x anisotropic",
              best->mse() <= reference.mse() / 4, figures);
    }
}

Result<void> write_report(const std::filesystem::path& folder, const proto::AccuracyReport& report) {
    const auto file = folder / "report.json";
    std::ofstream stream{file, std::ios::binary};
    stream << write_json(report) << std::flush;
    if (stream) return {};
    return Error{ErrorCode::io_failure, file.string() + ": cannot be written"};
}

std::string table_of(const proto::AccuracyReport& report) {
    std::vector<const AccuracyRow*> rows;
    for (const AccuracyRow& row : report.rows()) rows.push_back(&row);
    std::ranges::stable_sort(rows, [](const AccuracyRow* a, const AccuracyRow* b) {
        return std::tie(a->situation(), a->texture()) < std::tie(b->situation(), b->texture()) ||
               (are_alike(*a, *b) && a->mse() < b->mse());
    });
    std::string table = text("%-16s %-16s %-22s %10s %8s %8s %8s %8s %9s\n", "situation", "texture", "filter",
                             "MSE", "PSNR", "MS-SSIM", "max", "texels", "frame ms");
    for (const AccuracyRow* row : rows)
        table += text("%-16s %-16s %-22s %10.3f %8.2f %8.5f %8.1f %8.1f %9.2f%s\n", row->situation().c_str(),
                      row->texture().c_str(), row->filter().c_str(), row->mse(), row->psnr(), row->ms_ssim(),
                      row->max_error(), row->texels_per_sample(), row->frame_milliseconds(),
                      row->pareto() ? " *" : "");
    for (const proto::AccuracyClaim& made : report.claims())
        table +=
            std::string{made.holds() ? "holds: " : "FAILS: "} + made.text() + ": " + made.figures() + '\n';
    return table;
}

}  // namespace tessera
