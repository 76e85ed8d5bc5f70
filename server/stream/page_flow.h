#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>

#include "server/pages/page_service.h"
#include "server/stream/stream_options.h"
#include "shared/motion/validity.h"
#include "shared/revisions/revision.h"

namespace tessera {

/// What a client names a page's bytes by: all of the page's id, or its first half.
struct PageTag {
    PageId id;
    bool half = false;
    bool names(PageId other) const noexcept { return half ? id.high == other.high : id == other; }
};

/// A page that a client asked for.
struct StreamAsk {
    std::uint32_t id = 0;  ///< The client's number.
    PageKey key;
    Step step = 0;
    Revision least_revision = 0;
    Urgency urgency;
    std::optional<PageTag> have;  ///< Of the copy that the client has.
    bool brief = false;
    std::shared_ptr<const PageOptions> options;  ///< But for the step; shared by what was asked for at once.
};

/// The answer to an ask.
struct StreamPage {
    std::uint32_t id = 0;
    PageKey key;
    PageId tag;
    Revision revision = 0;        ///< The page's own.
    Revision scene_revision = 0;  ///< All edits up to this one are in it.
    PagePtr page;                 ///< Null: the client's copy is right, and more is not known.
    bool unchanged = false;       ///< The client's copy is right: its texels are not sent.
    bool brief = false;

    std::size_t bytes() const noexcept { return page && !unchanged ? page->bytes->size() : 0; }
};

/// The pages of one client between its ask and the answer: they wait here, are started in order of urgency
/// and only as far as credits reach, so that what is cancelled while it waits costs nothing; and when they
/// are done they wait for a credit and for the socket, few of them. No I/O, no locks.
class PageFlow {
  public:
    explicit PageFlow(const StreamOptions& options) : options_{options} {}

    enum class Added { yes, too_many, twice };
    Added add(StreamAsk ask);
    void grant(std::uint64_t credits) noexcept;
    /// False if it does not wait for its answer.
    bool cancel(std::uint32_t id);
    /// All of them go, and with them their places in the line.
    void clear();

    /// Names an ask that is under way; of two with the same id, the later one is another.
    using Number = std::uint64_t;
    struct Started {
        Number number = 0;
        StreamAsk ask;
    };
    /// The most urgent of those that wait, if it may begin now. It ends with finish() or drop().
    std::optional<Started> start();
    /// Where it waits at the page service.
    void set_ticket(const Started& started, PageService::Ticket ticket);
    /// Its answer is there. Where too many bytes wait for the socket it is given up, and started again later.
    /// Nothing if it was cancelled meanwhile.
    void finish(const Started& started, StreamPage page);
    /// It was refused. False if it was cancelled meanwhile.
    bool drop(const Started& started);

    /// The next to be sent, for one credit.
    std::optional<StreamPage> take();

    std::size_t waiting() const noexcept { return asks_.size(); }
    std::uint64_t credits() const noexcept { return credits_; }
    std::size_t held_bytes() const noexcept { return held_bytes_; }

  private:
    /// Pages that are started beyond the credits, so that the next credit finds one done.
    static constexpr std::size_t look_ahead = 2;

    enum class State { waiting, started, done };
    struct Ask {
        StreamAsk ask;
        Number number = 0;
        State state = State::waiting;
        PageService::Ticket ticket;
        std::optional<StreamPage> page;
    };
    struct Place {
        Urgency urgency;
        Number number = 0;  ///< The order of arrival.
        std::uint32_t id = 0;
        auto operator<=>(const Place&) const = default;
    };
    static Place place_of(const Ask& ask) { return {ask.ask.urgency, ask.number, ask.ask.id}; }
    Ask* find(const Started& started);
    void remove(std::unordered_map<std::uint32_t, Ask>::iterator ask);

    const StreamOptions& options_;
    std::unordered_map<std::uint32_t, Ask> asks_;
    std::set<Place> waiting_, done_;
    std::size_t started_ = 0;
    std::size_t held_bytes_ = 0;
    bool full_ = false;  ///< A page was given up for want of room: no other begins before one has left.
    std::uint64_t credits_ = 0;
    Number next_number_ = 0;
};

}  // namespace tessera
