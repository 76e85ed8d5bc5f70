#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "shared/revisions/revision.h"

namespace tessera {

/// An edit as others are told of it.
struct EditNews {
    Revision revision = 0;
    std::uint64_t session = 0;  ///< Who made it, and is told otherwise; 0: not on a stream.
    std::string message;        ///< The whole ServerMessage, made once for all readers.
};
using EditNewsPtr = std::shared_ptr<const EditNews>;

/// The last edits of a scene, for those that want to hear of every one. Bounded: who reads too slowly misses
/// some, and is told so. May be called from any thread.
class EditNewsRing {
  public:
    explicit EditNewsRing(std::size_t most = 1024, std::size_t most_bytes = std::size_t{1} << 20)
        : most_{most}, most_bytes_{most_bytes} {}

    /// In the order of revisions, without gaps.
    void add(EditNewsPtr news);
    /// An edit of this revision is not told one by one.
    void skip(Revision revision);

    struct Next {
        EditNewsPtr news;        ///< The first one after those that were told; null: no more.
        Revision missed_to = 0;  ///< Not 0: those up to here are not kept any more.
    };
    Next after(Revision told) const;

  private:
    const std::size_t most_, most_bytes_;
    mutable std::mutex mutex_;
    std::deque<EditNewsPtr> news_;
    std::size_t bytes_ = 0;
    Revision missed_to_ = 0;  ///< The last one that is not kept.
};

}  // namespace tessera
