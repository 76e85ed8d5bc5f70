#include "client/render/page_identity.h"

#include <string>
#include <vector>

#include <xxhash.h>

#include "client/render/plane_scene.h"

namespace tessera {
namespace {

std::uint64_t hash_of(std::string_view texels) { return XXH3_64bits(texels.data(), texels.size()); }

/// The entries that the GPU has of each level.
class GpuTable {
  public:
    GpuTable(const PageTableTexture& table, Extent extent, int window_side)
        : side_{static_cast<std::size_t>(window_side)},
          entries_(side_ * side_ * (std::size_t{extent.n} + 1)) {
        glPixelStorei(GL_PACK_ALIGNMENT, 4);
        glGetTextureImage(table.entries(), 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                          static_cast<GLsizei>(entries_.size() * sizeof(TableEntry)), entries_.data());
    }
    const TableEntry& at(PageKey page) const {
        return entries_[(page.level * side_ + page.y % side_) * side_ + page.x % side_];
    }

  private:
    std::size_t side_;
    std::vector<TableEntry> entries_;
};

}  // namespace

void PageIdentity::add(const ResidencyFrame& frame) {
    for (const SlotUpload& upload : frame.uploads) hashes_[upload.slot] = hash_of(upload.texels);
}

PageIdentity::Checked PageIdentity::check(const PlaneScene& scene, std::span<const NeededPage> sampled,
                                          std::size_t pages) {
    Checked checked;
    if (sampled.empty()) return checked;
    const Residency& residency = scene.residency();
    const GpuTable table{scene.page_table(), residency.extent(), residency.settings().window_side};
    std::string texels(slot_bytes, '\0');
    const std::size_t first = turn_;
    turn_ = (turn_ + pages) % sampled.size();
    for (std::size_t i = 0; i < sampled.size(); ++i) {
        const NeededPage& page = sampled[i];
        const auto shown = residency.table().shown_for(page.key);
        const TableEntry& entry = table.at(page.key);
        const bool is_its_own = static_cast<std::uint32_t>(entry.page_x) == page.key.x &&
                                static_cast<std::uint32_t>(entry.page_y) == page.key.y;
        const std::uint32_t expected =
            shown ? std::uint32_t{shown->slot} | std::uint32_t{shown->level} << 16 : TableEntry::nothing;
        checked.pixels += page.pixels;
        if (!is_its_own || entry.shown != expected) {
            checked.wrong += page.pixels;
            continue;
        }
        if (!shown || (i + sampled.size() - first % sampled.size()) % sampled.size() >= pages) continue;
        glGetTextureSubImage(scene.pages().coded_texture(), 0, 0, 0, shown->slot, slot_side_texels,
                             slot_side_texels, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                             static_cast<GLsizei>(texels.size()), texels.data());
        const auto brought = hashes_.find(shown->slot);
        if (brought != hashes_.end() && brought->second != hash_of(texels)) checked.wrong += page.pixels;
    }
    return checked;
}

}  // namespace tessera
