#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace tessera {

/// Who is at a scene, and where: the last word of each, and no history. Readers remember how far they have
/// read, so one that reads slowly hears the latest and nothing in between. May be called from any thread.
class PresenceBoard {
  public:
    using Session = std::uint64_t;

    /// `person`: a serialized proto::Present::Person.
    void set(Session session, std::string person);
    /// Nothing if it was never set.
    void leave(Session session);

    /// Counts what has happened; what a reader has read up to.
    using Version = std::uint64_t;
    struct News {
        std::vector<std::shared_ptr<const std::string>> people;
        std::vector<Session> left;
        Version version = 0;  ///< Read on from here.
        bool lost = false;    ///< So many have left since that not all are known any more.
        bool more = false;
    };
    /// What changed after `read`, at most `most` people; without `self`.
    News after(Version read, Session self, std::size_t most = 256) const;
    Version version() const;

  private:
    static constexpr std::size_t most_left = 4096;
    struct Person {
        Version version = 0;
        std::shared_ptr<const std::string> bytes;
    };
    struct Leaving {
        Version version = 0;
        Session session = 0;
    };

    mutable std::mutex mutex_;
    std::map<Session, Person> people_;
    std::map<Version, Session> changed_;  ///< The sessions of people_ by their versions.
    std::deque<Leaving> left_;
    Version version_ = 0, forgotten_ = 0;
};

}  // namespace tessera
