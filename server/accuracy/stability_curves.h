#pragma once

#include <vector>

#include "proto/accuracy.pb.h"

namespace tessera {

/// The greatest error, in codes of linear light, of the mean of 1 to 16 dark texels that stand at the end of
/// a column of `length` of the brightest ones, as a difference of two sums. Dark is sRGB codes 10 to 40.
struct ColumnErrors {
    double floats = 0;    ///< Sums in 32-bit floats, texels 0 to 1, as in the line-integral paper.
    double integers = 0;  ///< Modular 32-bit sums of 16-bit steps, as in server/filter.
};
ColumnErrors column_errors(std::size_t length);

/// The same for boxes of up to 16×16 dark texels in the last corner of a table of side² bright ones.
ColumnErrors table_errors(std::size_t side);

/// Both over the length: curves of report.json.
std::vector<proto::StabilityCurve> stability_curves(int most_length_log2);

}  // namespace tessera
