#pragma once

#include <memory>
#include <span>
#include <string>

#include "server/filter/footprint_sampler.h"
#include "server/filter/four.h"
#include "server/filter/page_tables.h"

namespace tessera {

/// What all samplers do: footprints are checked, the budget is looked at, and a filter's sums become a
/// sample. `Filter` is made of (filter, pages, memory_bytes), and answers for a footprint, with a Reading,
/// the colour in steps and how far that may be from the truth for all that is known of the texels.
struct Estimate {
    Doubles4 steps;
    double bound_codes = 0;  ///< Beyond the pages' own.
    double confidence = 1;
};

/// Rounds to 256ths of a step, far below a code and far above what sums in doubles lose: a constant stays
/// constant to the last bit, whatever it was summed by.
FilteredSample sample_of(const Estimate& estimate, const Reading& reading) noexcept;

/// What can be said of any estimate: every channel of the truth is between 0 and 1.
double bound_of_any(const Doubles4& steps) noexcept;

template <class Filter>
class EachFootprint final : public FootprintSampler {
  public:
    EachFootprint(const FootprintFilter& filter, std::shared_ptr<const TexelPages> pages,
                  std::size_t memory_bytes)
        : filter_{filter, std::move(pages), memory_bytes} {}

    Result<void> sample(std::span<const Footprint> footprints, const Budget& budget,
                        std::span<FilteredSample> samples) override {
        for (std::size_t i = 0; i < footprints.size(); ++i) {
            if (i % 16 == 0)
                if (const auto within = check_budget(budget); !within) return within;
            if (const auto sound = check_footprint(footprints[i]); !sound)
                return Error{sound.error().code,
                             "footprint " + std::to_string(i) + ": " + sound.error().detail};
            Reading reading{.slice = footprints[i].slice, .budget = &budget};
            const Estimate estimate = filter_(footprints[i], reading);
            if (reading.error) return *reading.error;
            samples[i] = sample_of(estimate, reading);
        }
        return {};
    }

  private:
    Filter filter_;
};

/// One for each kind of filter.
using MakeSampler = std::unique_ptr<FootprintSampler>(const FootprintFilter&,
                                                      std::shared_ptr<const TexelPages>, std::size_t);
MakeSampler make_nearest, make_bilinear, make_trilinear, make_anisotropic, make_ewa, make_summed_area,
    make_line_integral, make_supersampling, make_exact;

}  // namespace tessera
