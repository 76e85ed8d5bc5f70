#include "server/pattern/typed_texture.h"

#include <algorithm>
#include <numeric>
#include <type_traits>
#include <utility>

#include "server/pattern/cell_rows.h"
#include "server/pattern/cell_slice.h"
#include "server/pattern/node_tables.h"
#include "server/pattern/pixel_format.h"
#include "server/pattern/slice_cache.h"

namespace tessera {
namespace {

/// Rounding to float, the only error that there is: 255·2^−24, and as much again for sums of doubles.
constexpr double rounding_codes = 4e-5;
/// Images of all types at a level are kept if they take no more.
constexpr std::size_t kept_level_bytes = std::size_t{8} << 20;

/// Square images that lie ready, one for each type of the nodes of a height.
struct ReadyImages {
    const void* texels = nullptr;
    int side_log2 = 0;
    int height = 0;
    const std::int32_t* image_of_type = nullptr;
};

/// What the cells of one slice look like.
class SliceImages {
  public:
    virtual ~SliceImages() = default;
    /// Images of cells at `level` (0 to grid.cell_log2); nothing where they have to be drawn.
    virtual ReadyImages ready(int level, const LinearImage*) const = 0;
    virtual ReadyImages ready(int level, const Rgba8Image*) const = 0;
    /// The image of a cell that does not lie ready.
    virtual void draw(std::uint16_t type, int level, LinearImage& out) const = 0;
    virtual std::size_t memory_bytes() const noexcept = 0;
    const CellNodeTables& nodes() const { return *nodes_; }

  protected:
    std::unique_ptr<const CellNodeTables> nodes_;
};

/// Cells that each show one pattern: their images are the patterns' MIP chains.
class PatternSlice final : public SliceImages {
  public:
    PatternSlice(const Grid& grid, const PatternMips& mips, const std::vector<std::int32_t>& pattern_of_type,
                 std::int64_t slice)
        : mips_{mips} {
        std::vector<std::array<double, 4>> means;
        std::vector<float> quarters;
        for (const std::int32_t pattern : pattern_of_type) {
            const std::int32_t image = mips.image(pattern, slice);
            image_of_type_.push_back(image);
            means.push_back(mips.mean(image));
            if (grid.cell_log2 == 0) continue;
            const auto first = mips.linear(grid.cell_log2 - 1).values.begin() + std::ptrdiff_t{image} * 16;
            quarters.insert(quarters.end(), first, first + 16);
        }
        nodes_ = std::make_unique<CellNodeTables>(*grid.quadtree, grid.cell_log2, std::move(means),
                                                  std::move(quarters));
    }
    ReadyImages ready(int level, const LinearImage*) const override {
        return {mips_.linear(level).values.data(), mips_.side_log2() - level, 0, image_of_type_.data()};
    }
    ReadyImages ready(int level, const Rgba8Image*) const override {
        return {mips_.codes(level).bytes.data(), mips_.side_log2() - level, 0, image_of_type_.data()};
    }
    void draw(std::uint16_t type, int level, LinearImage& out) const override {
        const std::int32_t side = std::int32_t{1} << (mips_.side_log2() - level);
        const float* image = mips_.linear(level).row(image_of_type_[type] * side);
        out = LinearImage{side, side};
        std::copy_n(image, out.values.size(), out.values.begin());
    }
    std::size_t memory_bytes() const noexcept override {
        return image_of_type_.size() * sizeof image_of_type_[0] + nodes_->memory_bytes();
    }

  private:
    const PatternMips& mips_;
    std::vector<std::int32_t> image_of_type_;
};

/// Cells of any images: kept at the levels where all types together are small.
class DrawnSlice final : public SliceImages {
  public:
    DrawnSlice(const Grid& grid, const TypeImages& images, std::int32_t slice)
        : images_{images}, slice_{slice}, cell_log2_{grid.cell_log2} {
        const std::uint32_t types = grid.quadtree->types();
        identity_.resize(types);
        std::iota(identity_.begin(), identity_.end(), 0);
        const auto all_of_level = [&](int level) {
            const std::int32_t side = std::int32_t{1} << (cell_log2_ - level);
            LinearImage all{side, side * static_cast<std::int32_t>(types)}, one;
            for (std::uint32_t type = 0; type < types; ++type) {
                images.draw(static_cast<std::uint16_t>(type), level, slice, one);
                std::copy(one.values.begin(), one.values.end(),
                          all.row(static_cast<std::int32_t>(type) * side));
            }
            return all;
        };
        std::vector<std::array<double, 4>> means(types);
        const LinearImage cells = all_of_level(cell_log2_);
        for (std::size_t i = 0; i < cells.values.size(); ++i) means[i / 4][i % 4] = double{cells.values[i]};
        nodes_ = std::make_unique<CellNodeTables>(
            *grid.quadtree, cell_log2_, std::move(means),
            cell_log2_ > 0 ? all_of_level(cell_log2_ - 1).values : std::vector<float>{});
        for (int level = cell_log2_ - 2; level >= 0; --level) {
            const std::size_t bytes = (std::size_t{types} << 2 * (cell_log2_ - level)) * 20;
            if (bytes > kept_level_bytes) break;
            Level kept{all_of_level(level), {}};
            encode(kept.linear, kept.codes);
            levels_.push_back(std::move(kept));
        }
    }
    ReadyImages ready(int level, const LinearImage*) const override {
        return is_kept(level) ? ready_of(level, kept(level).linear) : ReadyImages{};
    }
    ReadyImages ready(int level, const Rgba8Image*) const override {
        return is_kept(level) ? ready_of(level, kept(level).codes) : ReadyImages{};
    }
    void draw(std::uint16_t type, int level, LinearImage& out) const override {
        images_.draw(type, level, slice_, out);
    }
    std::size_t memory_bytes() const noexcept override {
        std::size_t bytes = nodes_->memory_bytes() + identity_.size() * sizeof identity_[0];
        for (const Level& level : levels_)
            bytes += level.codes.bytes.size() + level.linear.values.size() * sizeof(float);
        return bytes;
    }

  private:
    struct Level {
        LinearImage linear;
        Rgba8Image codes;
    };
    bool is_kept(int level) const noexcept {
        return cell_log2_ - 2 - level < static_cast<int>(levels_.size());
    }
    const Level& kept(int level) const noexcept { return levels_[std::size_t(cell_log2_ - 2 - level)]; }
    template <class Image>
    ReadyImages ready_of(int level, const Image& images) const {
        return {texels_of(images).data(), cell_log2_ - level, 0, identity_.data()};
    }

    const TypeImages& images_;
    std::int32_t slice_;
    int cell_log2_;
    std::vector<std::int32_t> identity_;
    std::vector<Level> levels_;  ///< From the one of 4×4 texels on, finer ones behind.
};

/// Parts of a region's evaluation that both pixel formats share.
class TypedTexture : public PatternTexture {
  public:
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        return evaluate_into(region, budget, out);
    }
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                Rgba8Image& out) const override {
        return evaluate_into(region, budget, out);
    }
    /// Makes the tables of the first slice, so that no page waits for them.
    void prepare() const { of_slice(0); }
    std::string_view kind() const noexcept override { return "pattern"; }
    int cell_level() const noexcept override { return grid_.cell_log2; }
    std::size_t memory_bytes() const noexcept override {
        return sizeof *this + images_bytes() + grid_.quadtree->memory_bytes() +
               of_slice(0)->memory_bytes() *
                   std::min<std::size_t>(SliceCache<SliceImages>::most_kept, std::size_t(slices_));
    }

  protected:
    /// `slices`: of the images, before they repeat, or inside a cell that is 3D.
    TypedTexture(Grid grid, std::int32_t slices) : grid_{std::move(grid)}, slices_{slices} {}

    virtual std::shared_ptr<const SliceImages> make_slice(std::int64_t slice) const = 0;
    virtual std::size_t images_bytes() const noexcept = 0;

    std::string types_text() const {
        return std::to_string(grid_.quadtree->types()) + " types of cells of " +
               std::to_string(std::int64_t{1} << grid_.cell_log2) + " texels, exact at every level";
    }

    Grid grid_;
    std::int32_t slices_;

  private:
    std::shared_ptr<const SliceImages> of_slice(std::int64_t slice) const {
        return kept_.get(slice, [&](std::int64_t at) { return make_slice(at); });
    }

    template <class Image>
    Result<Evaluation> evaluate_into(const TexelRegion& region, const Budget& budget, Image& out) const {
        reshape(out, region.width, region.height);
        const CellSlice at = cell_slice(grid_, region.slice, slices_);
        const auto slice = of_slice(at.slice);
        if (region.level < slice->nodes().first_level()) {
            const ReadyImages ready = slice->ready(region.level, &out);
            return ready.texels != nullptr ? copy(region, budget, at.z, ready, "patterns", out)
                                           : draw_cells(region, budget, at.z, *slice, out);
        }
        const auto& nodes = slice->nodes();
        if constexpr (std::is_same_v<Image, LinearImage>) {
            const auto tables = nodes.linear(region.level);
            return copy(region, budget, at.z, {tables.texels, tables.side_log2, tables.height, nullptr},
                        "quadtree", out);
        } else {
            const auto tables = nodes.codes(region.level);
            return copy(region, budget, at.z, {tables.texels, tables.side_log2, tables.height, nullptr},
                        "quadtree", out);
        }
    }

    /// Nodes that a region meets.
    struct Nodes {
        std::int64_t x, y;
        std::int32_t width, height;
        TypeGrid types;
    };
    Nodes nodes_under(const TexelRegion& region, std::int64_t z, int side_log2, int height) const {
        Nodes nodes{region.x >> side_log2, region.y >> side_log2, 0, 0, {}};
        nodes.width = static_cast<std::int32_t>(((region.x + region.width - 1) >> side_log2) - nodes.x + 1);
        nodes.height = static_cast<std::int32_t>(((region.y + region.height - 1) >> side_log2) - nodes.y + 1);
        nodes.types = grid_.quadtree->types_of(height, nodes.x, nodes.y, nodes.width, nodes.height, z);
        return nodes;
    }

    template <class Image>
    Result<Evaluation> copy(const TexelRegion& region, const Budget& budget, std::int64_t z,
                            const ReadyImages& ready, std::string_view method, Image& out) const {
        const Nodes nodes = nodes_under(region, z, ready.side_log2, ready.height);
        std::vector<std::int32_t> index(std::size_t(nodes.width));
        CellRowCopy rows{.images = ready.texels,
                         .index = index.data(),
                         .side_log2 = ready.side_log2,
                         .skip = static_cast<std::int32_t>(region.x - (nodes.x << ready.side_log2)),
                         .width = region.width,
                         .out_row_texels = std::size_t(region.width)};
        const std::int32_t side = std::int32_t{1} << ready.side_log2;
        for (std::int64_t y = nodes.y; y < nodes.y + nodes.height; ++y) {
            if (auto spent = check_budget(budget); !spent) return spent.error();
            const std::uint16_t* types = nodes.types.row(y) + (nodes.x - nodes.types.x);
            if (ready.image_of_type != nullptr)
                for (std::size_t i = 0; i < index.size(); ++i) index[i] = ready.image_of_type[types[i]];
            else
                for (std::size_t i = 0; i < index.size(); ++i) index[i] = types[i];
            const std::int64_t top = y << ready.side_log2;
            rows.from_row = static_cast<std::int32_t>(std::max<std::int64_t>(region.y - top, 0));
            rows.to_row =
                static_cast<std::int32_t>(std::min<std::int64_t>(region.y + region.height - top, side));
            rows.out = out.row(static_cast<std::int32_t>(top + rows.from_row - region.y));
            copy_cell_rows<texel_bytes<Image>>(rows);
        }
        return Evaluation{.method = method,
                          .bound_codes = rounding_codes,
                          .work = std::uint64_t(nodes.width) * std::uint64_t(nodes.height)};
    }

    /// Levels whose images are not kept: each cell that the region meets is drawn.
    Result<Evaluation> draw_cells(const TexelRegion& region, const Budget& budget, std::int64_t z,
                                  const SliceImages& slice, LinearImage& out) const {
        const int side_log2 = grid_.cell_log2 - region.level;
        const Nodes nodes = nodes_under(region, z, side_log2, 0);
        const std::int64_t side = std::int64_t{1} << side_log2;
        LinearImage cell;
        for (std::int64_t y = nodes.y; y < nodes.y + nodes.height; ++y)
            for (std::int64_t x = nodes.x; x < nodes.x + nodes.width; ++x) {
                if (auto spent = check_budget(budget); !spent) return spent.error();
                slice.draw(nodes.types.at(x, y), region.level, cell);
                const std::int64_t left = std::max(x * side, region.x);
                const std::int64_t right = std::min((x + 1) * side, region.x + region.width);
                const std::int64_t bottom = std::min((y + 1) * side, region.y + region.height);
                for (std::int64_t row = std::max(y * side, region.y); row < bottom; ++row)
                    std::copy_n(cell.row(static_cast<std::int32_t>(row - y * side)) + (left - x * side) * 4,
                                (right - left) * 4,
                                out.row(static_cast<std::int32_t>(row - region.y)) + (left - region.x) * 4);
            }
        return Evaluation{.method = "patterns",
                          .bound_codes = rounding_codes,
                          .work = std::uint64_t(nodes.width) * std::uint64_t(nodes.height)};
    }
    Result<Evaluation> draw_cells(const TexelRegion& region, const Budget& budget, std::int64_t z,
                                  const SliceImages& slice, Rgba8Image& out) const {
        LinearImage linear{region.width, region.height};
        const auto evaluation = draw_cells(region, budget, z, slice, linear);
        if (evaluation) encode(linear, out);
        return evaluation;
    }

    SliceCache<SliceImages> kept_;
};

class TypedPatterns final : public TypedTexture {
  public:
    TypedPatterns(const Grid& grid, std::shared_ptr<const PatternMips> mips,
                  std::vector<std::int32_t> pattern_of_type)
        : TypedTexture{grid, mips->slices()},
          mips_{std::move(mips)},
          pattern_of_type_{std::move(pattern_of_type)} {}
    std::string description() const override {
        return std::to_string(mips_->count()) + " patterns, " + types_text();
    }

  private:
    std::shared_ptr<const SliceImages> make_slice(std::int64_t slice) const override {
        return std::make_shared<PatternSlice>(grid_, *mips_, pattern_of_type_, slice);
    }
    std::size_t images_bytes() const noexcept override {
        return mips_->memory_bytes() + pattern_of_type_.size() * sizeof pattern_of_type_[0];
    }

    std::shared_ptr<const PatternMips> mips_;
    std::vector<std::int32_t> pattern_of_type_;
};

class TypedImages final : public TypedTexture {
  public:
    TypedImages(const Grid& grid, std::shared_ptr<const TypeImages> images)
        : TypedTexture{grid, grid.cell_slices > 0 ? grid.cell_slices : images->slices()},
          images_{std::move(images)} {}
    std::string description() const override { return images_->description() + ", " + types_text(); }

  private:
    std::shared_ptr<const SliceImages> make_slice(std::int64_t slice) const override {
        return std::make_shared<DrawnSlice>(grid_, *images_, static_cast<std::int32_t>(slice));
    }
    std::size_t images_bytes() const noexcept override { return images_->memory_bytes(); }

    std::shared_ptr<const TypeImages> images_;
};

}  // namespace

std::shared_ptr<const PatternTexture> make_typed_texture(const Grid& grid,
                                                         std::shared_ptr<const TypeImages> images) {
    auto texture = std::make_shared<TypedImages>(grid, std::move(images));
    texture->prepare();
    return texture;
}

std::shared_ptr<const PatternTexture> make_typed_texture(const Grid& grid,
                                                         std::shared_ptr<const PatternMips> patterns,
                                                         std::vector<std::int32_t> pattern_of_type) {
    auto texture = std::make_shared<TypedPatterns>(grid, std::move(patterns), std::move(pattern_of_type));
    texture->prepare();
    return texture;
}

}  // namespace tessera
