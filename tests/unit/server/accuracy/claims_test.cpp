#include "server/accuracy/claims.h"

#include <string>

#include <gmock/gmock.h>

namespace tessera {
namespace {

proto::AccuracyRow& add_row(proto::AccuracyReport& report, const char* situation, const char* filter,
                            double mse, bool pareto) {
    proto::AccuracyRow& row = *report.add_rows();
    row.set_situation(situation);
    row.set_texture("photograph");
    row.set_filter(filter);
    row.set_where("cpu");
    row.set_mse(mse);
    row.set_pareto(pareto);
    row.set_truth_mse(0.01);
    return row;
}

/// Line integrals that are better everywhere, and on the front in `fronts` situations.
proto::AccuracyReport made_report(int fronts) {
    proto::AccuracyReport report;
    for (const char* situation : {"grazing-plane", "checker-horizon", "corridor"}) {
        add_row(report, situation, "anisotropic-16", 10, true);
        add_row(report, situation, "line-integral-vertical", 12, false);
        add_row(report, situation, "line-integral-8", 5, fronts-- > 0);
    }
    return report;
}

const proto::AccuracyClaim* claim(const proto::AccuracyReport& report, const std::string& words) {
    for (const proto::AccuracyClaim& one : report.claims())
        if (one.text().find(words) != std::string::npos) return &one;
    return nullptr;
}

TEST(Claims, TheFrontInTwoSituationsIsEnoughAndOneIsNot) {
    for (const int fronts : {0, 1, 2, 3}) {
        proto::AccuracyReport report = made_report(fronts);
        add_claims({}, report);
        ASSERT_NE(claim(report, "Pareto front"), nullptr);
        EXPECT_EQ(claim(report, "Pareto front")->holds(), fronts >= 2) << fronts;
    }
}

TEST(Claims, BestOfTwoMustWinInAllThreeSituationsAndByItself) {
    proto::AccuracyReport report = made_report(2);
    add_claims({}, report);
    EXPECT_TRUE(claim(report, "Best of two")->holds());
    report = made_report(2);
    report.mutable_rows(8)->set_mse(11);  // Best of two loses in the corridor
    report.mutable_rows(7)->set_mse(9);   // where one direction still wins
    add_claims({}, report);
    EXPECT_FALSE(claim(report, "Best of two")->holds());
    EXPECT_TRUE(claim(report, "At some setting")->holds());
    EXPECT_THAT(claim(report, "Best of two")->figures(),
                testing::HasSubstr("corridor: line-integral-8 MSE 11 against 10"));
}

TEST(Claims, WhatWasNotMeasuredIsNotClaimed) {
    proto::AccuracyReport report;
    add_row(report, "corridor", "line-integral", 1, true);
    add_claims({}, report);
    EXPECT_EQ(claim(report, "Pareto front"), nullptr);
    EXPECT_EQ(claim(report, "Best of two"), nullptr);
}

TEST(Claims, ABoundThatIsBrokenIsSaid) {
    proto::AccuracyReport report = made_report(2);
    report.mutable_rows(1)->set_truth_mse(0);
    add_claims({}, report);
    EXPECT_TRUE(claim(report, "certain bound")->holds());
    report.clear_claims();
    report.mutable_rows(1)->set_beyond_bound(0.2);
    add_claims({}, report);
    EXPECT_FALSE(claim(report, "certain bound")->holds());
    EXPECT_THAT(claim(report, "certain bound")->figures(), testing::HasSubstr("line-integral-vertical"));
}

TEST(Claims, ACurveOfIntegersMayNotRise) {
    proto::AccuracyReport report = made_report(2);
    proto::StabilityCurve& curve = *report.add_curves();
    curve.set_name("column sums in modular integers");
    curve.set_x_name("texels");
    curve.add_x(16);
    curve.add_y(0);
    add_claims({}, report);
    EXPECT_TRUE(claim(report, "modular integers")->holds());
    report.clear_claims();
    report.mutable_curves(0)->set_y(0, 0.02);
    add_claims({}, report);
    EXPECT_FALSE(claim(report, "modular integers")->holds());
}

}  // namespace
}  // namespace tessera
