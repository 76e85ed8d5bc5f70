#include "server/scene/kept_files.h"

#include "proto/pattern.pb.h"

#include "server/texture/texture.h"

namespace tessera {

namespace {

template <class Kept, class Read>
auto kept(std::mutex& mutex, std::map<std::string, Kept>& all, const std::string& key, const Read& read)
    -> Result<Kept> {
    const std::lock_guard lock{mutex};
    if (const auto found = all.find(key); found != all.end()) return found->second;
    auto value = read();
    if (!value) return value.error();
    return all.emplace(key, std::move(*value)).first->second;
}

}  // namespace

Result<std::shared_ptr<const PatternImages>> KeptFiles::patterns(const std::string& field,
                                                                 const proto::PatternSet& set) {
    return kept(mutex_, patterns_, set.SerializeAsString(),
                [&] { return files_.share_patterns(field, set); });
}

Result<StoredMap> KeptFiles::map(const std::string& field, const std::string& image) {
    return kept(mutex_, maps_, image, [&] { return files_.read_map(field, image); });
}

Result<std::shared_ptr<const Texture>> KeptFiles::exchange(const std::string& field,
                                                           const proto::Block& block) {
    proto::Block nameless = block;
    nameless.clear_name();
    nameless.clear_editable();
    return kept(mutex_, exchanges_, nameless.SerializeAsString(),
                [&] { return files_.read_exchange(field, block); });
}

Result<PatternImages> EditedFiles::read_patterns(const std::string& field, const proto::PatternSet& set) {
    const auto shared = share_patterns(field, set);
    if (!shared) return shared.error();
    return **shared;
}

}  // namespace tessera
