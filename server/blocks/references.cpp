#include "server/blocks/references.h"

namespace tessera {

namespace {

constexpr std::uint32_t bit(Output output) noexcept { return 1u << static_cast<unsigned>(output); }
constexpr std::uint32_t integers = bit(Output::integer);
constexpr std::uint32_t numbers = bit(Output::integer) | bit(Output::number);

class List {
  public:
    explicit List(std::vector<BlockReference>& references) : references_{references} {}

    void name(std::string field, const std::string& name, std::uint32_t allowed) {
        references_.push_back({std::move(field), name, allowed, no_block});
    }
    void optional_name(std::string field, const std::string& text, std::uint32_t allowed) {
        if (!text.empty()) name(std::move(field), text, allowed);
    }
    void value(std::string field, const proto::Value& value, std::uint32_t allowed) {
        if (value.value_case() == proto::Value::kBlock) name(std::move(field), value.block(), allowed);
    }
    void textures(const google::protobuf::RepeatedPtrField<std::string>& names) {
        for (int i = 0; i < names.size(); ++i)
            name(".textures[" + std::to_string(i) + "]", names[i], bit(Output::texture));
    }

  private:
    std::vector<BlockReference>& references_;
};

}  // namespace

BlockShape shape_of(const proto::Block& block) {
    BlockShape shape;
    List list{shape.references};
    const std::uint32_t grid = bit(Output::grid);
    switch (block.block_case()) {
        case proto::Block::kPatternSet:
            shape.kind = "pattern_set", shape.output = Output::patterns;
            break;
        case proto::Block::kVirtualTileMap:
            shape.kind = "virtual_tile_map", shape.output = Output::grid;
            break;
        case proto::Block::kExplicitIndirectionMap:
            shape.kind = "explicit_indirection_map", shape.output = Output::integer;
            list.name(".grid", block.explicit_indirection_map().grid(), grid);
            break;
        case proto::Block::kVirtualIndirectionMap:
            shape.kind = "virtual_indirection_map", shape.output = Output::integer;
            list.name(".grid", block.virtual_indirection_map().grid(), grid);
            break;
        case proto::Block::kVirtualRandomMap:
            shape.kind = "virtual_random_map", shape.output = Output::number;
            list.name(".grid", block.virtual_random_map().grid(), grid);
            break;
        case proto::Block::kProbabilityMap:
            shape.kind = "probability_map", shape.output = Output::integer;
            list.value(".index", block.probability_map().index(), integers);
            break;
        case proto::Block::kMaterialsMap:
            shape.kind = "materials_map", shape.output = Output::integer;
            list.value(".material", block.materials_map().material(), integers);
            list.value(".index", block.materials_map().index(), integers);
            break;
        case proto::Block::kAreasMap:
            shape.kind = "areas_map", shape.output = Output::integer;
            list.name(".grid", block.areas_map().grid(), grid);
            break;
        case proto::Block::kDitheredAreasMap:
            shape.kind = "dithered_areas_map", shape.output = Output::integer;
            list.name(".areas.grid", block.dithered_areas_map().areas().grid(), grid);
            break;
        case proto::Block::kTransitionTiles:
            shape.kind = "transition_tiles", shape.output = Output::integer;
            list.value(".material", block.transition_tiles().material(), integers);
            list.value(".index", block.transition_tiles().index(), integers);
            break;
        case proto::Block::kAnimationSequence:
            shape.kind = "animation_sequence", shape.output = Output::sequence;
            break;
        case proto::Block::kAnimationMap:
            shape.kind = "animation_map", shape.output = Output::integer;
            list.name(".sequence", block.animation_map().sequence(), bit(Output::sequence));
            list.value(".phase", block.animation_map().phase(), numbers);
            list.value(".rest", block.animation_map().rest(), numbers);
            for (int i = 0; i < block.animation_map().changes_size(); ++i) {
                const std::string change = ".changes[" + std::to_string(i) + "]";
                list.value(change + ".phase", block.animation_map().changes(i).phase(), numbers);
                list.value(change + ".rest", block.animation_map().changes(i).rest(), numbers);
            }
            break;
        case proto::Block::kTileTransform:
            shape.kind = "tile_transform", shape.output = Output::transform;
            list.name(".grid", block.tile_transform().grid(), grid);
            list.value(".x", block.tile_transform().x(), numbers);
            list.value(".y", block.tile_transform().y(), numbers);
            list.value(".scale", block.tile_transform().scale(), numbers);
            list.value(".turn", block.tile_transform().turn(), numbers);
            break;
        case proto::Block::kReferenceTexture:
            shape.kind = "reference_texture", shape.output = Output::texture;
            list.name(".patterns", block.reference_texture().patterns(), bit(Output::patterns));
            list.name(".grid", block.reference_texture().grid(), grid);
            list.value(".index", block.reference_texture().index(), integers);
            list.optional_name(".transform", block.reference_texture().transform(), bit(Output::transform));
            break;
        case proto::Block::kPixelMap:
            shape.kind = "pixel_map", shape.output = Output::texture;
            list.textures(block.pixel_map().textures());
            break;
        case proto::Block::kLayers:
            shape.kind = "layers", shape.output = Output::texture;
            list.textures(block.layers().textures());
            break;
        case proto::Block::kConstant:
            shape.kind = "constant", shape.output = Output::texture;
            break;
        case proto::Block::kContentExchange:
            shape.kind = "content_exchange", shape.output = Output::texture;
            break;
        case proto::Block::kInterchange:
            shape.kind = "interchange", shape.output = Output::texture;
            break;
        case proto::Block::kWang:
            shape.kind = "wang", shape.output = Output::texture;
            break;
        case proto::Block::BLOCK_NOT_SET:
            break;
    }
    return shape;
}

}  // namespace tessera
