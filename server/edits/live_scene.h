#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "proto/edit.pb.h"

#include "server/edits/apply_edit.h"
#include "server/edits/live_document.h"
#include "server/edits/sprite_book.h"
#include "server/journal/journal.h"
#include "server/progress/progress.h"
#include "server/scene/scene.h"

namespace tessera {

/// Why an edit is not in, or not known to be.
struct EditRefusal {
    enum class Why {
        wrong,          ///< The edit itself: malformed, or not possible now.
        conflict,       ///< base_revision is not the head; read the present state, and decide again.
        other_content,  ///< The id was used for another edit.
        too_old,        ///< known_revision is beyond what the journal remembers.
        overloaded,     ///< Passing.
        unavailable,  ///< The disk is full or fails, or the journal is closed. Passing, for those who run it.
        unknown,      ///< In or not in: ask again with the same id.
    };
    Why why{};
    std::string detail;
    Revision head = 0;  ///< The scene's revision, as far as it is known.
};

using EditOutcome = std::variant<proto::EditAnswer, EditRefusal>;

/// A scene that takes edits: what was accepted is in the journal first, then in the next now().
///
/// An edit is validated against the state that all edits before it left. Edits that arrive while others are
/// being committed are committed together. What the journal tells is the truth: after a restart the same
/// edits in the same order give the same scene. All members may be called from any thread.
class LiveScene final : public SceneNow {
  public:
    /// Edits that wait for the commit before theirs; beyond it, overloaded.
    static constexpr std::size_t max_waiting = 4096;
    /// Edits of more than sprites that are compiled at once.
    static constexpr std::size_t max_in_group = 256;

    /// `base` takes edits: it has sprites, or a document. Brings it to the state of the journal's head.
    /// Errors: io_failure, invalid_input, in the journal's words.
    static Result<std::unique_ptr<LiveScene>> open(ScenePtr base, std::unique_ptr<Journal> journal,
                                                   Progress& progress);

    /// close().
    ~LiveScene() override;

    /// Takes no more edits, commits what is in the journal's queue, and answers everybody. Not on a thread of
    /// the journal. Idempotent; now() goes on.
    void close();

    /// The scene with all edits that were acknowledged.
    ScenePtr now() const override { return now_.load(); }

    /// Names the journal's history: another one counts its revisions from 0 again.
    std::string lineage() const { return to_string(lineage_); }

    /// Of its journal; none once it is closed.
    std::optional<JournalStatus> journal_status() const;

    /// The scene file or its assets have changed: the same sprites over another ground. What edits changed in
    /// the file's own words stays as they left it. `base` as of open(). Takes as long as planning the scene,
    /// and edits and pages go on meanwhile. By one thread at a time.
    void rebase(ScenePtr base);

    /// Which step it shows when.
    SceneClock clock() const;
    /// All that edits may have changed, as snapshots hold it: at a revision that now() may not have yet.
    proto::LiveState state() const;

    using Handler = std::function<void(EditOutcome)>;
    /// `handler` is called once, when the edit is in for good and now() has it, or when it is refused; on
    /// another thread or before returning, and it must not block.
    void edit(proto::Edit edit, Handler handler);

    /// What now() has that it had not before.
    struct Change {
        Revision revision = 0;
        std::vector<TexelBox> dirty;
        std::shared_ptr<const proto::Edit> edit;  ///< With its id; null if it could not be read.
    };
    /// Called after now() has changed and before the edits are answered, on a thread of the journal; must not
    /// block. Until the pointer that is returned is let go.
    using Listener = std::function<void(const std::vector<Change>&)>;
    [[nodiscard]] std::shared_ptr<void> listen(Listener listener);

  private:
    /// Edits of more than sprites that are compiled once, and go to the journal together.
    struct Group {
        std::shared_ptr<const LiveDocument> before, after;
        ScenePtr ground;  ///< Compiled of `after`; null where that is of the same as before.
    };

    /// An edit from its arrival to its answer.
    struct Work {
        proto::Edit edit;
        Append append;
        Handler handler;
        std::optional<AppliedEdit> applied;    ///< What it did to book_, and is to do to document_.
        std::shared_ptr<Group> group;          ///< With which it goes to the journal; null: by itself.
        std::optional<DocumentEdit> document;  ///< Made before it goes there.
        std::optional<EditOutcome> outcome;
        bool is_in = false;  ///< In the journal already, as far as its id tells.
    };

    LiveScene(ScenePtr base, std::unique_ptr<Journal> journal);
    // Of restarts (recovery.cpp)
    Result<void> recover(Progress& progress);
    Result<void> replay(Revision head, Progress& progress);
    void apply(const Edit& edit, Planning planning);
    void count_planned(const std::vector<Change>& changes);
    void keep_snapshot();
    static proto::LiveState state_of(const PositioningMap& map, const LiveDocument& document,
                                     Revision revision);

    struct Rebased {
        std::shared_ptr<const LiveDocument> document;
        ScenePtr ground;
    };
    Result<Rebased> rebased(const ScenePtr& base, const LiveDocument& document) const;

    // Each of these is called with the lock, and gives it back unlocked
    void commit(std::unique_lock<std::mutex> lock);
    void catch_up(std::unique_lock<std::mutex> lock, Revision target);
    void finish(std::unique_lock<std::mutex> lock);

    void settle(std::vector<AppendOutcome> outcomes);
    void take_history(History history, Revision target);
    void ask_for_retries(std::vector<Work> refused);
    void take_back();
    const PositioningMap& sprites_at_head() const noexcept;
    void publish();
    SceneClock::Time now_at() const;

    // Of edits that change more than sprites (ground_lane.cpp)
    void run_lane(std::stop_token stop);
    void prepare(std::vector<Work> works, std::unique_lock<std::mutex>& lock);
    void take_group(std::vector<Append>& batch);
    void end_group();
    Result<ScenePtr> compile(const LiveDocument& document) const;
    void compile_document();
    SpritePatterns patterns() const noexcept;

    const std::string id_;
    std::atomic<ScenePtr> now_;

    mutable std::mutex mutex_;  ///< Guards what follows; never held while waiting for the disk or a handler.
    ScenePtr base_;
    SpriteBook book_;                               ///< At head_, and with what is being committed.
    std::optional<PositioningMap> before_commit_;   ///< At head_, while book_ has more than that.
    std::shared_ptr<const LiveDocument> document_;  ///< At head_.
    ScenePtr ground_;                               ///< Compiled of document_, but for its targets.
    std::shared_ptr<const LiveDocument> compiled_;  ///< What ground_ was compiled of.
    std::deque<Work> unprepared_;                   ///< That change more than sprites.
    std::shared_ptr<Group> in_commit_;              ///< The group that is being committed.
    bool group_waits_ = false;                      ///< One is prepared and not yet decided.
    std::size_t most_in_next_ = max_in_group;       ///< Of the lane alone: fewer, after too much together.
    std::condition_variable_any lane_wakes_;
    std::jthread lane_;
    PageRevisions page_revisions_;
    Revision head_ = 0;
    std::deque<Work> waiting_;
    std::vector<Work> committing_;  ///< In the order of the journal's outcomes.
    std::vector<Work> impossible_;  ///< Could not be applied; perhaps retries of what is in already.
    std::vector<Change> changes_;   ///< Of the last commit.
    bool commits_ = false;
    bool closing_ = false;
    Journal::Ticket follows_;
    std::vector<std::weak_ptr<Listener>> listeners_;
    std::jthread snapshots_;
    bool keeps_snapshot_ = false;
    std::size_t planned_since_snapshot_ = 0;  ///< Edits for which a restart would plan the scene.
    bool replay_unsettled_ = false;           ///< The next that looks at maps is one of them.
    bool snapshot_wanted_ = false;
    static constexpr std::size_t page_revision_bytes = std::size_t{32} << 20;

    std::unique_ptr<Journal> owned_journal_;
    Journal* const journal_;  ///< The same; it still answers while it is being closed.
    const EditId lineage_;
};

}  // namespace tessera
