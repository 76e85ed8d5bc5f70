#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/blocks/plan.h"
#include "server/pattern/instance_images.h"
#include "server/pattern/joint_types.h"
#include "server/pattern/pattern_mips.h"

namespace tessera {

/// What costs time to make and does not change from one compilation of a scene to the next: images, and
/// tables of typed textures. Found by all that they are made of. All members may be called from any thread.
struct PatternKept {
  public:
    std::shared_ptr<const PatternMips> mips(const std::shared_ptr<const PatternImages>& patterns);
    std::shared_ptr<const InstanceImages> instances(const ReferencePlan& plan);

    /// The texture of `key`, made if there is none.
    template <class Make>
    std::shared_ptr<const Texture> texture(const std::string& key, const Make& make) {
        {
            const std::lock_guard lock{mutex_};
            if (Entry<Texture>* found = find(textures_, key)) return found->is;
        }
        auto made = make();
        const std::lock_guard lock{mutex_};
        textures_[key] = {made, nullptr, round_};
        return made;
    }

    /// A compilation is over: forgets what neither it nor the one before used.
    void next_round();

  private:
    template <class T>
    struct Entry {
        std::shared_ptr<const T> is;
        std::shared_ptr<const PatternImages> of;  ///< Keeps the address that the key names.
        std::uint64_t round = 0;                  ///< When it was used last.
    };
    template <class T>
    Entry<T>* find(std::map<std::string, Entry<T>>& all, const std::string& key) {
        const auto found = all.find(key);
        if (found == all.end()) return nullptr;
        found->second.round = round_;
        return &found->second;
    }

    std::mutex mutex_;  ///< Guards what follows.
    std::uint64_t round_ = 1;
    std::map<std::string, Entry<PatternMips>> mips_;
    std::map<std::string, Entry<InstanceImages>> instances_;
    std::map<std::string, Entry<Texture>> textures_;
};

/// All that a typed or constant reference texture is made of.
std::string key_of(const ReferencePlan& plan);
/// All that a joint texture is made of.
std::string key_of(const JointPart& whole);

}  // namespace tessera
