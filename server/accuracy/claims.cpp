#include "server/accuracy/claims.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "server/accuracy/report_rows.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 3> all_situations{"grazing-plane", "checker-horizon", "corridor"};
constexpr std::string_view reference = "anisotropic-16";

[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...) {
    std::array<char, 512> text{};
    va_list arguments;
    va_start(arguments, pattern);
    std::vsnprintf(text.data(), text.size(), pattern, arguments);
    va_end(arguments);
    return text.data();
}

void add(proto::AccuracyReport& report, const std::string& text, bool holds, const std::string& figures) {
    proto::AccuracyClaim& claim = *report.add_claims();
    claim.set_text(text);
    claim.set_holds(holds);
    claim.set_figures(figures);
}

using Wanted = std::function<bool(const proto::AccuracyRow&)>;

/// The processor's rows of a situation and a texture that are wanted.
std::vector<const proto::AccuracyRow*> rows_of(const proto::AccuracyReport& report,
                                               std::string_view situation, std::string_view texture,
                                               const Wanted& wanted) {
    std::vector<const proto::AccuracyRow*> found;
    for (const proto::AccuracyRow& row : report.rows())
        if (row.where() == on_cpu && row.situation() == situation && row.texture() == texture && wanted(row))
            found.push_back(&row);
    std::ranges::sort(found, {}, [](const auto* row) { return row->nanoseconds_per_sample(); });
    return found;
}

const proto::AccuracyRow* least_wrong(const std::vector<const proto::AccuracyRow*>& rows) {
    const auto least = std::ranges::min_element(rows, {}, [](const auto* row) { return row->mse(); });
    return least == rows.end() ? nullptr : *least;
}

bool is_line_integral(const proto::AccuracyRow& row) { return row.filter().starts_with("line-integral"); }
bool is_best_of_two(const proto::AccuracyRow& row) {
    return is_line_integral(row) && row.filter().find("vertical") == std::string::npos &&
           row.filter().find("horizontal") == std::string::npos;
}

void add_pareto_claim(proto::AccuracyReport& report, std::string_view texture) {
    int on_front = 0, seen = 0;
    std::string figures;
    for (const std::string_view situation : all_situations) {
        const auto lines = rows_of(report, situation, texture, is_line_integral);
        if (lines.empty()) continue;
        ++seen;
        std::vector<const proto::AccuracyRow*> front;
        std::ranges::copy_if(lines, std::back_inserter(front), [](const auto* row) { return row->pareto(); });
        on_front += front.empty() ? 0 : 1;
        figures += format("%s%s: %zu settings", figures.empty() ? "" : "; ", std::string{situation}.c_str(),
                          front.size());
        if (!front.empty())
            figures += format(", from %s (MSE %.3g, %.0f ns) to %s (MSE %.3g, %.0f ns)",
                              front.front()->filter().c_str(), front.front()->mse(),
                              front.front()->nanoseconds_per_sample(), front.back()->filter().c_str(),
                              front.back()->mse(), front.back()->nanoseconds_per_sample());
    }
    if (seen == 3)
        add(report,
            "The line integral lies on the Pareto front of error against time in at least two of the three "
            "situations: " +
                std::string{texture},
            on_front >= 2, figures);
}

void add_error_claim(proto::AccuracyReport& report, std::string_view texture, const std::string& text,
                     const Wanted& wanted) {
    int better = 0, seen = 0;
    std::string figures;
    for (const std::string_view situation : all_situations) {
        const auto* lines = least_wrong(rows_of(report, situation, texture, wanted));
        const auto* probes = least_wrong(
            rows_of(report, situation, texture, [](const auto& row) { return row.filter() == reference; }));
        if (lines == nullptr || probes == nullptr) continue;
        ++seen;
        better += lines->mse() < probes->mse() ? 1 : 0;
        figures +=
            format("%s%s: %s MSE %.3g against %.3g", figures.empty() ? "" : "; ",
                   std::string{situation}.c_str(), lines->filter().c_str(), lines->mse(), probes->mse());
    }
    if (seen == 3)
        add(report, text + ": " + std::string{texture}, better == 3,
            figures + "; the paper: 20.7, 7.4, 35.7 against 27.1, 6.6, 50.1");
}

void add_bound_claims(const ClaimFacts& facts, proto::AccuracyReport& report) {
    double beyond = 0, worst_exact = 0, exact_excess = 0;
    std::size_t analytic = 0, exact = 0;
    std::string worst = "none";
    for (const proto::AccuracyRow& row : report.rows()) {
        if (row.where() != on_cpu) continue;
        if (row.truth_mse() == 0) {
            ++analytic;
            if (row.beyond_bound() > beyond)
                worst = row.filter() + " on " + row.texture() + ", " + row.situation();
            beyond = std::max(beyond, row.beyond_bound());
        }
        if (row.filter() != "exact") continue;
        ++exact;
        if (row.truth_mse() == 0)
            worst_exact = std::max(worst_exact, row.mse());
        else
            exact_excess = std::max(exact_excess, row.mse() / row.truth_mse());
    }
    if (analytic > 0)
        add(report,
            "No sample lies beyond the certain bound that its filter states, where the truth is analytic",
            beyond <= 1e-3,
            format("%zu rows, the worst %.4f codes beyond (%s)", analytic, beyond, worst.c_str()));
    if (exact > 0)
        add(report,
            "The exact filter is the truth: rounding where that is analytic, the truth's own error where it "
            "is sampled",
            worst_exact < 1e-2 && exact_excess < 2,
            format(
                "MSE at most %.2g against analytic truth, at most %.2f times the sampled truth's own error",
                worst_exact, exact_excess));
    add(report, "Every filter leaves one colour as it is, in every situation", facts.worst_on_constant < 0.01,
        format("at most %.4f codes of linear light off", facts.worst_on_constant));
}

void add_truth_claim(proto::AccuracyReport& report) {
    double worst = 0;
    std::string where;
    std::size_t sampled = 0;
    for (const proto::AccuracyRow& row : report.rows())
        if (row.where() == on_cpu && row.truth_mse() > 0) {
            ++sampled;
            if (row.truth_mse() > worst) where = row.texture() + ", " + row.situation();
            worst = std::max(worst, row.truth_mse());
        }
    if (sampled > 0)
        add(report, "Where the truth is sampled, its own error is known and below a code", worst < 1,
            format("expected squared error at most %.3f codes² (%s)", worst, where.c_str()));
}

void add_curve_claims(proto::AccuracyReport& report) {
    for (const proto::StabilityCurve& curve : report.curves()) {
        double greatest = 0, at_65536 = -1, fails = 0;
        for (int i = 0; i < curve.x_size(); ++i) {
            greatest = std::max(greatest, curve.y(i));
            if (curve.x(i) == 65536) at_65536 = curve.y(i);
            if (fails == 0 && curve.y(i) > 0.5) fails = curve.x(i);
        }
        if (curve.name().find("integers") != std::string::npos)
            add(report, "Below 0.01 code off at any length: " + curve.name(), greatest < 0.01,
                format("at most %.4f codes up to %.0f %s", greatest, curve.x(curve.x_size() - 1),
                       curve.x_name().c_str()));
        else
            add(report, "Half a code off and more at some length: " + curve.name(), fails > 0,
                fails > 0 ? format("from %.0f %s on%s", fails, curve.x_name().c_str(),
                                   at_65536 >= 0 ? format("; %.2f codes at 65,536", at_65536).c_str() : "")
                          : std::string{"not up to the greatest length"});
    }
}

void add_page_claims(proto::AccuracyReport& report) {
    std::size_t bounded = 0, kept = 0;
    double naive = 0, shallow = 0, deep = 0;
    int naive_level = 0;
    std::string naive_texture;
    for (const proto::PageRow& row : report.pages()) {
        if ((row.comparison() == "statistical" || row.comparison() == "descent") && row.confidence() >= 1) {
            ++bounded;
            kept += row.max_error() <= row.bound_codes() + 0.02 ? 1 : 0;
        }
        if (row.comparison() == "light" && row.setting() == "sRGB codes" && row.mse() > naive) {
            naive = row.mse();
            naive_level = static_cast<int>(row.level());
            naive_texture = row.texture();
        }
        if (row.comparison() == "content-depth" && row.setting() == "8-bit sRGB")
            shallow = std::max(shallow, row.max_error());
        if (row.comparison() == "content-depth" && row.setting() == "16-bit linear")
            deep = std::max(deep, row.max_error());
    }
    if (bounded > 0)
        add(report, "Pages keep the certain bounds that they state", kept == bounded,
            format("%zu of %zu rows", kept, bounded));
    if (naive > 0)
        add(report, "Filtering sRGB codes instead of light is visible: more than a code off", naive > 1,
            format("MSE up to %.0f (%s, level %d); linear light costs no more time", naive,
                   naive_texture.c_str(), naive_level));
    if (shallow > 0)
        add(report, "Contents kept in 16 bits stay below 0.05 code where 8 bits are a code and more off",
            deep < 0.05 && shallow > 1, format("%.4f against %.2f codes of linear light", deep, shallow));
}

}  // namespace

void add_claims(const ClaimFacts& facts, proto::AccuracyReport& report) {
    std::vector<std::string> textures;
    for (const proto::AccuracyRow& row : report.rows())
        if (std::ranges::count(textures, row.texture()) == 0) textures.push_back(row.texture());
    for (const std::string& texture : textures) {
        add_pareto_claim(report, texture);
        add_error_claim(
            report, texture,
            "At some setting the line integral has lower error than 16 probes in all three situations",
            is_line_integral);
        add_error_claim(report, texture,
                        "Best of two directions has lower error than 16 probes in all three situations",
                        is_best_of_two);
    }
    add_bound_claims(facts, report);
    add_truth_claim(report);
    add_page_claims(report);
    add_curve_claims(report);
}

}  // namespace tessera
