#include "client/edit/edit_run.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "client/edit/edit_json.h"
#include "client/edit/edit_lines.h"
#include "client/edit/edit_words.h"
#include "client/link/stream_client.h"
#include "shared/revisions/edit_id.h"

namespace tessera {

namespace asio = boost::asio;

namespace {

constexpr std::size_t most_edits_under_way = 256;

StreamSettings settings_of(const EditOptions& options) {
    const bool watches = options.task == EditOptions::Task::watch;
    StreamSettings settings;
    settings.name = options.name;
    settings.token = options.token;
    settings.wants_presence = settings.wants_edits = watches;
    settings.edit_patience = options.patience;
    settings.max_edits = most_edits_under_way;
    settings.longest_back_off = std::chrono::seconds{2};  // somebody waits at the shell
    return settings;
}

/// All pages of the coarse levels: 1 + 4 + 16 + … + 1024.
std::vector<proto::Window> coarse_windows(unsigned n) {
    std::vector<proto::Window> windows;
    for (unsigned up = 0; up <= std::min(n, 5u); ++up) {
        proto::Window& window = windows.emplace_back();
        window.set_level(n - up);
        window.set_x1(1 << up);
        window.set_y1(1 << up);
    }
    return windows;
}

class Run final : public StreamListener {
  public:
    explicit Run(const EditOptions& options)
        : options_{options}, signals_{context_, SIGINT, SIGTERM}, timer_{context_} {
        client_ = std::make_unique<StreamClient>(context_.get_executor(), options_.server, options_.scene,
                                                 settings_of(options_), *this);
        signals_.async_wait([this](boost::system::error_code error, int) {
            if (!error) end(130);
        });
        if (options_.task == EditOptions::Task::edit) make(options_.edit, "");
        if (options_.seconds) {
            timer_.expires_after(*options_.seconds);
            timer_.async_wait([this](boost::system::error_code error) {
                if (!error) end(exit_code_);
            });
        }
    }

    int run() {
        context_.run();
        return exit_code_;
    }

  private:
    using Task = EditOptions::Task;

    void on_open(const proto::ServerHello& hello) override {
        trouble_.clear();
        if (options_.task == Task::lines && !lines_) {
            const auto take = [this](const std::string& line, std::size_t number) {
                take_line(line, number);
            };
            const auto stop = [this](const std::string& problem) { no_more_lines(problem); };
            lines_ = std::make_unique<InputLines>(context_.get_executor(), most_edits_under_way, take, stop);
        }
        if (options_.task != Task::watch) return;
        proto::ServerMessage told;
        *told.mutable_hello() = hello;
        say(told);
        if (!is_open_once_ || !hello.resumed())
            client_->watch(
                options_.windows.empty() ? coarse_windows(hello.extent_log2_pages()) : options_.windows,
                hello.revision());
        is_open_once_ = true;
    }

    void on_lost(const Error& why, std::chrono::milliseconds) override {
        const bool is_hopeless =
            why.code == ErrorCode::no_such_scene || why.code == ErrorCode::malformed_request;
        // Before the first hello, nobody is sure that there is a server
        const bool is_tried_again =
            client_->statistics().connections > 0 || why.code == ErrorCode::overloaded;
        if (options_.task == Task::watch) {
            proto::ServerMessage told;
            told.mutable_goodbye()->set_detail(why.detail);
            if (is_open_once_ && trouble_.empty()) say(told);
        }
        if (is_hopeless || !is_tried_again) {
            std::cerr << "tessera-edit: " << why.detail << "\n";
            return end(1);
        }
        if (trouble_.empty()) std::cerr << "tessera-edit: " << why.detail << "; trying again\n";
        trouble_ = why.detail;
    }

    void on_invalidation(const proto::Invalidation& told) override {
        if (options_.task != Task::watch || told.stale().empty()) return;
        proto::ServerMessage message;
        *message.mutable_invalidation() = told;
        say(message);
    }
    void on_edit(const proto::EditDone& told) override {
        if (options_.task != Task::watch) return;
        proto::ServerMessage message;
        *message.mutable_edit_done() = told;
        say(message);
        if (options_.edits && ++edits_heard_ >= *options_.edits) end(exit_code_);
    }
    void on_present(const proto::Present& told) override {
        if (options_.task != Task::watch) return;
        proto::ServerMessage message;
        *message.mutable_present() = told;
        say(message);
    }
    void on_clock(const proto::ClockNow& told) override {
        if (options_.task != Task::watch) return;
        proto::ServerMessage message;
        *message.mutable_clock() = told;
        say(message);
    }

    void take_line(const std::string& line, std::size_t number) {
        const std::string where = "line " + std::to_string(number);
        auto edit = edit_in(line, where);
        if (edit) {
            if (edit->author().empty()) edit->set_author(options_.name);
            return make(std::move(*edit), where);
        }
        proto::EditRefused refusal;
        refusal.set_detail(edit.error().detail);
        tell({}, refusal);
        exit_code_ = std::max(exit_code_, 3);
        if (lines_) lines_->done();
    }

    void no_more_lines(const std::string& problem) {
        is_read_ = true;
        if (!problem.empty()) {
            std::cerr << "tessera-edit: " << problem << "\n";
            exit_code_ = std::max(exit_code_, 3);
        }
        if (under_way_ == 0) end(exit_code_);
    }

    /// `where`: the line that it came from; "": the command line.
    void make(proto::Edit edit, const std::string& where) {
        ++under_way_;
        if (edit.id().empty()) edit.set_id(to_string(random_edit_id()));
        client_->edit(edit, [this, edit, where](const EditFate& fate) {
            --under_way_;
            if (const auto* answer = std::get_if<proto::EditAnswer>(&fate)) {
                tell(edit, *answer);
            } else {
                const auto& refusal = std::get<proto::EditRefused>(fate);
                tell(edit, refusal);
                exit_code_ = std::max(exit_code_, refusal.why() == proto::EditRefused::unknown ? 4 : 3);
            }
            if (lines_) lines_->done();
            if (options_.task == Task::edit || (is_read_ && under_way_ == 0)) end(exit_code_);
        });
    }

    void tell(const proto::Edit& edit, const proto::EditAnswer& answer) {
        if (options_.json || options_.task == Task::lines) return say(told_fate(edit.id(), answer));
        std::cout << words_of(edit, answer) << std::endl;
    }
    void tell(const proto::Edit& edit, const proto::EditRefused& refusal) {
        if (options_.json || options_.task == Task::lines) return say(told_fate(refusal));
        std::cerr << "tessera-edit: " << words_of(edit, refusal) << std::endl;
    }
    /// A line at once, for whoever reads along.
    void say(const proto::ServerMessage& told) {
        std::cout << json_line(told) << std::endl;
        if (!std::cout) end(exit_code_);  // nobody reads any more
    }

    void end(int exit_code) {
        exit_code_ = exit_code;
        lines_.reset();
        client_.reset();
        context_.stop();
    }

    const EditOptions& options_;
    asio::io_context context_{1};
    asio::signal_set signals_;
    asio::steady_timer timer_;
    std::unique_ptr<StreamClient> client_;
    std::unique_ptr<InputLines> lines_;
    bool is_open_once_ = false;
    bool is_read_ = false;  ///< Standard input is at its end.
    std::size_t under_way_ = 0;
    std::uint64_t edits_heard_ = 0;
    std::string trouble_;
    int exit_code_ = 0;
};

}  // namespace

int run_edits(const EditOptions& options) { return Run{options}.run(); }

}  // namespace tessera
