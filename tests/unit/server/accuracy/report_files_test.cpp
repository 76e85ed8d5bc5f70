#include "server/accuracy/report_files.h"

#include <gmock/gmock.h>

#include "server/accuracy/filter_family.h"
#include "server/accuracy/plot_picture.h"
#include "server/accuracy/report_page.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

proto::AccuracyReport made_report() {
    proto::AccuracyReport report;
    report.set_machine("</script><b>a machine");
    double time = 10;
    for (const char* situation : {"grazing-plane", "checker-horizon", "corridor"})
        for (const char* filter : {"nearest", "trilinear", "anisotropic-16", "line-integral", "exact"}) {
            proto::AccuracyRow& row = *report.add_rows();
            row.set_situation(situation);
            row.set_texture("photograph");
            row.set_filter(filter);
            row.set_where("cpu");
            row.set_mse(1000 / time);
            row.set_nanoseconds_per_sample(time *= 1.7);
            row.set_pareto(true);
        }
    return report;
}

TEST(ReportCsv, HasANameForEachColumnAndALineForEachRow) {
    proto::AccuracyReport report = made_report();
    report.mutable_rows(0)->set_where("a renderer, \"fast\"");
    const std::string csv = report_csv(report);
    EXPECT_EQ(std::ranges::count(csv, '\n'), 16);
    EXPECT_THAT(
        csv, HasSubstr("\n\"grazing-plane\",\"photograph\",\"nearest\",\"a renderer, \"\"fast\"\"\",100,"));
    const auto head = csv.substr(0, csv.find('\n')), last = csv.substr(csv.rfind('\n', csv.size() - 2) + 1);
    EXPECT_EQ(std::ranges::count(head, ','), std::ranges::count(last, ','));
}

TEST(ReportPage, HoldsTheReportAndCannotBeBrokenByIt) {
    const std::string page = report_page(made_report());
    EXPECT_THAT(page, HasSubstr("\\u003c/script"));
    EXPECT_THAT(page, Not(HasSubstr("<b>a machine")));
    for (const char* mark : {"/*STYLE*/", "/*SCRIPT*/", "/*REPORT*/", "/*FAMILIES*/", "/*SITUATIONS*/"})
        EXPECT_THAT(page, Not(HasSubstr(mark)));
}

TEST(DrawPlot, ShowsEachFilterInItsColour) {
    const Rgba8Image plot = draw_plot(made_report());
    ASSERT_GT(plot.width, 1000);
    for (const FilterFamily& family : filter_families) {
        const bool drawn = [&] {
            for (std::size_t i = 0; i < plot.bytes.size(); i += 4)
                if (std::equal(family.color.begin(), family.color.end(),
                               plot.bytes.begin() + std::ptrdiff_t(i)))
                    return true;
            return false;
        }();
        const bool wanted = family.prefix == "nearest" || family.prefix == "trilinear" ||
                            family.prefix == "anisotropic" || family.prefix == "line-integral" ||
                            family.prefix == "exact";
        if (wanted) {
            EXPECT_TRUE(drawn) << family.title;
        }
    }
}

TEST(FilterFamilies, AreToldApartByTheLongestName) {
    EXPECT_EQ(family_of("line-integral-vertical-24").title, "line integral, vertical");
    EXPECT_EQ(family_of("line-integral-24").title, "line integral, best of two");
    EXPECT_EQ(family_of("supersampling-jittered-8x8").title, "supersampling");
}

}  // namespace
}  // namespace tessera
