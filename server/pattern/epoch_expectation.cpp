#include "server/pattern/epoch_expectation.h"

#include <algorithm>
#include <utility>

#include "shared/math/hash.h"

namespace tessera {

namespace {

/// Animation of less than this, in codes, is left out.
constexpr double budget_codes = 0.5;

/// A program whose shares are those of an epoch.
class ProgramOfEpoch final : public CellProgram {
  public:
    ProgramOfEpoch(std::shared_ptr<const CellProgram> program, const Epoch& epoch)
        : program_{std::move(program)}, epoch_{epoch} {}

    void patterns(const CellRow& row, std::int32_t* out) const override { program_->patterns(row, out); }
    void looks(const CellRow& row, Look* out) const override { program_->looks(row, out); }
    Basis basis() const noexcept override { return program_->basis(); }
    bool needs_types() const noexcept override { return program_->needs_types(); }
    bool independent_cells() const noexcept override { return program_->independent_cells(); }
    Look look_of_type(std::uint16_t type) const override { return program_->look_of_type(type); }
    std::optional<VaryingMap> varying() const override { return program_->varying(); }
    std::vector<LookShare> shares(std::span<const std::int32_t> states) const override {
        return program_->shares_in(epoch_, states);
    }
    std::size_t memory_bytes() const noexcept override { return 0; }

  private:
    std::shared_ptr<const CellProgram> program_;
    Epoch epoch_;
};

}  // namespace

EpochExpectation::EpochExpectation(std::shared_ptr<const CellProgram> program, const LookMeans& means,
                                   double width)
    : program_{std::move(program)}, means_{means}, width_{width} {
    const auto first = of_slice(0);
    known_ = first->is != nullptr;
    certain_ = known_ && first->is->bound(1).codes == 0;
}

std::shared_ptr<const EpochExpectation::Kept> EpochExpectation::of_slice(std::int64_t slice) const {
    return kept_.get(slice, [&](std::int64_t at) {
        return std::make_shared<const Kept>(
            Kept{nullptr, make_area_expectation(*program_, means_, static_cast<std::int32_t>(at))});
    });
}

std::shared_ptr<const EpochExpectation::Kept> EpochExpectation::of_epoch(std::int64_t slice,
                                                                         const Epoch& epoch) const {
    const auto key = static_cast<std::int64_t>(
        hash(epoch.average ? 1 : 2,
             stream("epoch", epoch.setting) ^ static_cast<std::uint64_t>(epoch.parameter),
             epoch.validity.from, slice) >>
        1);
    return kept_.get(key, [&](std::int64_t) {
        auto program = std::make_unique<const ProgramOfEpoch>(program_, epoch);
        auto is = make_area_expectation(*program, means_, static_cast<std::int32_t>(slice), epoch.uneven);
        return std::make_shared<const Kept>(Kept{std::move(program), std::move(is)});
    });
}

Result<Evaluation> EpochExpectation::evaluate(const TexelRegion& region, std::int64_t slice, int up,
                                              const Budget& budget, LinearImage& out) const {
    if (!program_->moves()) return of_slice(slice)->is->evaluate(region, up, budget, out);
    const double uneven_codes = 255 * width_;
    const Epoch epoch = program_->epoch(region.step, region.parameter,
                                        uneven_codes > budget_codes ? budget_codes / uneven_codes : 1.0);
    auto evaluation = of_epoch(slice, epoch)
                          ->is->evaluate(region, up, budget, out, program_->scroll().at(region.step).shift);
    if (!evaluation) return evaluation;
    if (!uniform() && program_->scroll().cells != 0) {
        const std::int64_t n = std::int64_t{1} << up;
        evaluation->validity.meet(
            program_->through_map({.x = region.x * n,
                                   .y = region.y * n,
                                   .width = static_cast<std::int32_t>(region.width * n),
                                   .height = static_cast<std::int32_t>(region.height * n),
                                   .step = region.step}));
    }
    evaluation->bound_codes = std::min(evaluation->bound_codes + epoch.uneven * uneven_codes,
                                       std::max(evaluation->bound_codes, uneven_codes));
    evaluation->validity.meet(epoch.validity);
    return evaluation;
}

std::size_t EpochExpectation::memory_bytes() const {
    if (!known_) return 0;
    const auto slices = static_cast<std::size_t>(program_->moves() ? std::int64_t{8} : means_.slices);
    return of_slice(0)->is->memory_bytes() * std::min(SliceCache<Kept>::most_kept, slices);
}

}  // namespace tessera
