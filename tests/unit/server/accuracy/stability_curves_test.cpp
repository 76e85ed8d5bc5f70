#include "server/accuracy/stability_curves.h"

#include <gmock/gmock.h>

namespace tessera {
namespace {

TEST(StabilityCurves, A65536TexelColumnIsExactInIntegersAndACodeOffInFloats) {
    const ColumnErrors errors = column_errors(65536);
    EXPECT_LT(errors.integers, 0.01);
    EXPECT_GT(errors.floats, 0.25);
}

TEST(StabilityCurves, FloatsGetWorseUntilAllIsLostAndIntegersDoNot) {
    double before = -1;
    for (const int log2 : {8, 12, 16, 20, 22}) {
        const ColumnErrors errors = column_errors(std::size_t{1} << log2);
        EXPECT_GE(errors.floats, before) << log2;
        EXPECT_EQ(errors.integers, 0) << log2;
        before = errors.floats;
    }
    EXPECT_GT(before, 2);
}

TEST(StabilityCurves, TablesFailEarlierSinceTheirSumsGrowWithTheArea) {
    EXPECT_GT(table_errors(1024).floats, column_errors(1024).floats * 4);
    EXPECT_EQ(table_errors(1024).integers, 0);
    EXPECT_EQ(table_errors(17).integers, 0);
}

TEST(StabilityCurves, HaveAPointForEachLength) {
    const auto curves = stability_curves(10);
    ASSERT_EQ(curves.size(), 4u);
    EXPECT_EQ(curves[0].x_size(), 7);
    EXPECT_EQ(curves[0].x(6), 1024);
    for (const auto& curve : curves) EXPECT_EQ(curve.x_size(), curve.y_size());
}

}  // namespace
}  // namespace tessera
