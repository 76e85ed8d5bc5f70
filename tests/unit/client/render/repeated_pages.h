#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/render/integral_store.h"
#include "client/render/page_store.h"
#include "client/render/page_table_texture.h"
#include "client/render/whole_texture.h"
#include "client/residency/page_source.h"
#include "shared/math/hash.h"

namespace tessera::testing {

/// An image of noise that no two texels share, in square patches so that coarse levels are not grey.
inline Rgba8Image noise_image(std::int32_t side) {
    Rgba8Image image{side, side};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::uint64_t fine = hash(3, stream("fine"), x, y),
                                coarse = hash(3, stream("coarse"), x / 19, y / 13);
            for (std::size_t c = 0; c < 3; ++c)
                image.row(y)[4 * static_cast<std::size_t>(x) + c] =
                    static_cast<std::uint8_t>((coarse >> (8 * c) & 1) * 150 + (fine >> (8 * c)) % 106);
            image.row(y)[4 * x + 3] = 255;
        }
    return image;
}

inline Rgba8Image constant_image(std::int32_t side, std::array<std::uint8_t, 3> codes) {
    Rgba8Image image{side, side};
    for (std::size_t at = 0; at < image.bytes.size(); ++at)
        image.bytes[at] = at % 4 == 3 ? 255 : codes[at % 4];
    return image;
}

/// A page, gutter and all, of an image that repeats for ever.
inline std::string page_of(const std::vector<Rgba8Image>& levels, PageKey page) {
    const Rgba8Image& level = levels[std::min<std::size_t>(page.level, levels.size() - 1)];
    const auto wrapped = [&](std::int64_t at) { return static_cast<std::int32_t>(at & (level.width - 1)); };
    std::string bytes;
    bytes.reserve(slot_bytes);
    for (std::int64_t y = -gutter_texels; y < page_side_texels + gutter_texels; ++y)
        for (std::int64_t x = -gutter_texels; x < page_side_texels + gutter_texels; ++x)
            bytes.append(reinterpret_cast<const char*>(
                             level.row(wrapped(std::int64_t{page.y} * page_side_texels + y)) +
                             4 * wrapped(std::int64_t{page.x} * page_side_texels + x)),
                         4);
    return bytes;
}

/// The pages that cover a rectangle of level 0, of these many levels, resident.
class RepeatedPages {
  public:
    RepeatedPages(const std::vector<Rgba8Image>& image, Extent extent, PlanePoint centre, PlanePoint low,
                  PlanePoint high, int levels)
        : table_{extent, 32}, table_texture_{extent, 32} {
        std::vector<PageKey> keys;
        for (int l = 0; l < levels; ++l)
            for (std::int64_t y = low.y >> (8 + l); y <= high.y >> (8 + l); ++y)
                for (std::int64_t x = low.x >> (8 + l); x <= high.x >> (8 + l); ++x)
                    keys.push_back({static_cast<std::uint8_t>(l), static_cast<std::uint32_t>(x),
                                    static_cast<std::uint32_t>(y)});
        store_ = std::make_unique<PageStore>(keys.size());
        table_.move_to(centre.x, centre.y);
        for (std::size_t slot = 0; slot < keys.size(); ++slot) {
            store_->upload(static_cast<Slot>(slot), page_of(image, keys[slot]));
            table_.show(keys[slot], {static_cast<Slot>(slot), keys[slot].level, 0});
        }
        table_texture_.update(table_);
        auto made = IntegralStore::make(keys.size());
        if (!made) throw std::runtime_error{made.error().detail};
        integrals_ = std::move(*made);
        for (int slot = 0; slot < static_cast<int>(keys.size()); ++slot)
            integrals_->upload_from(store_->coded_texture(), gutter_texels, slot, slot);
    }

    TexelTextures textures() const {
        return {.colour = store_->texture(),
                .coded = store_->coded_texture(),
                .table = table_texture_.texture(),
                .integrals = integrals_->texture(),
                .integral_table = table_texture_.texture()};
    }

  private:
    PageTable table_;
    PageTableTexture table_texture_;
    std::unique_ptr<PageStore> store_;
    std::unique_ptr<IntegralStore> integrals_;
};

}  // namespace tessera::testing
