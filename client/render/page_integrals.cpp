#include "client/render/page_integrals.h"

#include <algorithm>
#include <bit>

#include "client/residency/page_source.h"

namespace tessera {
namespace {

constexpr std::size_t least_places = 64;
/// The level byte of an entry: nothing is shown.
constexpr std::uint32_t nothing = 255U << 16;

}  // namespace

PageIntegrals::PageIntegrals(Extent extent, int window_side, std::size_t slots)
    : slots_(slots), window_side_{window_side}, entries_(static_cast<std::size_t>(extent.n) + 1) {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    table_ = GlTexture{name};
    glTextureStorage3D(name, 1, GL_RGBA8, window_side, window_side, extent.n + 1);
}

Result<void> PageIntegrals::begin_frame(std::span<const Slot> shown) {
    if (shown.size() > places_.size())
        if (const auto grown = grow(shown.size()); !grown) return grown.error();
    shown_.assign(shown.begin(), shown.end());
    ++frame_;
    for (const Slot slot : shown_) {
        slots_[slot].frame = frame_;
        if (const int place = slots_[slot].place; place != none)
            places_[static_cast<std::size_t>(place)].frame = frame_;
    }
    return {};
}

/// To so many, and a quarter more, so that it is not done again with every step of the camera.
Result<void> PageIntegrals::grow(std::size_t places) {
    const std::size_t roomy = std::min(std::max(places + places / 4, least_places), slots_.size());
    auto made = IntegralStore::make(roomy);
    if (!made) made = IntegralStore::make(places);
    if (!made) return made.error();
    if (store_) (*made)->copy_from(*store_);
    store_ = std::move(*made);
    places_.resize(store_->bytes() / IntegralStore::page_bytes);
    return {};
}

void PageIntegrals::forget(Slot slot) {
    int& place = slots_[slot].place;
    if (place == none) return;
    places_[static_cast<std::size_t>(place)] = {};
    place = none;
    moved_ = true;
}

int PageIntegrals::take_place(Slot slot) {
    if (slots_[slot].place != none) return slots_[slot].place;
    const auto longest = std::ranges::min_element(
        places_, {}, [](const Place& place) { return place.slot == none ? 0 : place.frame; });
    if (longest == places_.end() || (longest->slot != none && longest->frame == frame_)) return none;
    if (longest->slot != none) slots_[static_cast<std::size_t>(longest->slot)].place = none;
    // What is not shown yet makes room for what is
    *longest = {slot, slots_[slot].frame == frame_ ? frame_ : frame_ - 1};
    slots_[slot].place = static_cast<int>(longest - places_.begin());
    moved_ = true;
    return slots_[slot].place;
}

void PageIntegrals::upload(Slot slot, std::string_view texels) {
    if (const int place = take_place(slot); place != none) store_->upload(place, texels, gutter_texels);
}

void PageIntegrals::bring(GLuint coded_pages, const PageTable& table, int coarsest_changed) {
    for (const Slot slot : shown_) {
        if (slots_[slot].place != none) continue;
        const int place = take_place(slot);
        if (place != none) store_->upload_from(coded_pages, gutter_texels, slot, place);
    }
    const int coarsest = moved_ ? table.extent().n : coarsest_changed;
    moved_ = false;
    bring_table(table, coarsest);
}

/// Coarse levels first: an entry without sums is like its parent's.
void PageIntegrals::bring_table(const PageTable& table, int coarsest) {
    const std::int32_t mask = window_side_ - 1;
    const int wrapped_bits = std::countr_zero(static_cast<unsigned>(window_side_));
    const auto index_of = [&](std::int32_t x, std::int32_t y) {
        return static_cast<std::size_t>((y & mask) * window_side_ + (x & mask));
    };
    std::vector<std::uint32_t> made;
    for (int level = coarsest; level >= 0; --level) {
        const auto l = static_cast<std::size_t>(level);
        const bool is_top = l + 1 == entries_.size();
        const auto coarser =
            is_top ? std::span<const TableEntry>{} : table.entries(static_cast<std::uint8_t>(level + 1));
        made.clear();
        for (const TableEntry& entry : table.entries(static_cast<std::uint8_t>(level))) {
            std::uint32_t shown = nothing;
            const std::uint32_t slot = entry.shown & 0xffff;
            if (entry.shown != TableEntry::nothing && slots_[slot].place != none) {
                shown = static_cast<std::uint32_t>(slots_[slot].place) | (entry.shown & 0xff0000);
            } else if (entry.shown != TableEntry::nothing && !is_top) {
                const std::int32_t x = entry.page_x >> 1, y = entry.page_y >> 1;
                const TableEntry& above = coarser[index_of(x, y)];
                if (above.page_x == x && above.page_y == y)
                    shown = entries_[l + 1][index_of(x, y)] & 0xffffff;
            }
            const auto tag = static_cast<std::uint32_t>(((entry.page_x >> wrapped_bits) & 15) |
                                                        ((entry.page_y >> wrapped_bits) & 15) << 4);
            made.push_back(shown | tag << 24);
        }
        if (made == entries_[l]) continue;
        entries_[l] = made;
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        glTextureSubImage3D(table_.name(), 0, 0, 0, level, window_side_, window_side_, 1, GL_RGBA,
                            GL_UNSIGNED_INT_8_8_8_8_REV, made.data());
    }
}

}  // namespace tessera
