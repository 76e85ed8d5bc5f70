#include "server/http/server.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <latch>

#include <boost/asio/post.hpp>

#include "server/http/io_thread.h"
#include "server/http/listener.h"

namespace tessera {

namespace asio = boost::asio;

Server::Server(const ServerOptions& options)
    : options_{options},
      metrics_{registry_},
      pages_{options.pages, registry_, page_prelude},
      samples_{options.samples, registry_},
      edits_{options.edits, registry_},
      streams_{options.streams, pages_, edits_, registry_},
      bodies_{options.bodies_bytes},
      routes_{pages_, samples_, edits_, registry_} {
    for (std::size_t i = 0; i < std::max<std::size_t>(options.io_threads, 1); ++i)
        threads_.push_back(std::make_unique<IoThread>(
            SessionContext{options.session, routes_, pages_, samples_, edits_, bodies_, metrics_,
                           std::make_unique<StreamThread>(streams_)}));
}

Result<std::unique_ptr<Server>> Server::start(const ServerOptions& options) {
    std::unique_ptr<Server> server{new Server{options}};
    auto listener = Listener::open(options, server->threads_, server->metrics_);
    if (!listener) return listener.error();
    server->listener_ = std::move(*listener);
    for (const auto& thread : server->threads_) thread->start();
    server->listener_->start();
    return server;
}

Server::~Server() {
    stop();
    // Sessions that the grace period cut off give up their tickets here, while the service is still alive
    listener_.reset();
    threads_.clear();
}

template <class Job>
void Server::on_every_thread(Job job) {
    std::latch done{static_cast<std::ptrdiff_t>(threads_.size())};
    std::exception_ptr failure;
    for (const auto& thread : threads_) {
        try {
            asio::post(thread->io, [&, context = &thread->context] {
                job(*context);
                done.count_down();
            });
        } catch (...) {  // the jobs that were posted hold references: wait for them all the same
            failure = std::current_exception();
            done.count_down();
        }
    }
    done.wait();
    if (failure) std::rethrow_exception(failure);
}

void Server::publish(std::shared_ptr<const Catalog> catalog, std::shared_ptr<const WebFiles> web,
                     std::shared_ptr<const Access> access) {
    const std::lock_guard lock{publishing_};
    if (stopped_) return;
    metrics_.scenes.Set(static_cast<double>(catalog->scenes.size()));
    metrics_.scenes_broken.Set(static_cast<double>(catalog->broken.size()));
    streams_.follow_scenes();
    on_every_thread([&](SessionContext& context) {
        context.site.catalog = catalog;
        context.site.web = web;
        context.site.access = access;
        context.streams->publish(catalog, access);
    });
    samples_.forget_scenes();
}

bool Server::sessions_left() {
    std::atomic<std::size_t> left = 0;
    on_every_thread(
        [&](SessionContext& context) { left += context.sessions.size() + context.streams->size(); });
    return left != 0;
}

void Server::stop() {
    {
        const std::lock_guard lock{publishing_};
        if (std::exchange(stopped_, true) || !listener_) return;
    }
    const auto wait_for_sessions = [this](std::chrono::milliseconds time) {
        const auto until = std::chrono::steady_clock::now() + time;
        while (sessions_left() && std::chrono::steady_clock::now() < until)
            std::this_thread::sleep_for(std::chrono::milliseconds{5});
    };
    asio::post(threads_.front()->io, [this] { listener_->close(); });
    // All are told before one connection closes: who sees one close finds that the others end, too
    on_every_thread([](SessionContext& context) { context.site.draining = true; });
    on_every_thread([](SessionContext& context) {
        for (Session* session : context.sessions) session->drain();
        context.streams->drain();
    });
    wait_for_sessions(options_.grace);
    on_every_thread([](SessionContext& context) {
        for (Session* session : context.sessions) session->abort();
        context.streams->abort();
    });
    wait_for_sessions(std::chrono::milliseconds{500});
    for (const auto& thread : threads_) thread->io.stop();
    for (const auto& thread : threads_) thread->thread.join();
    pages_.stop();
    samples_.stop();
    edits_.close();
}

std::uint16_t Server::port() const { return listener_->endpoint().port(); }

std::string Server::address() const {
    const auto endpoint = listener_->endpoint();
    const std::string host = endpoint.address().to_string();
    return "http://" + (endpoint.address().is_v6() ? "[" + host + "]" : host) + ":" +
           std::to_string(endpoint.port());
}

}  // namespace tessera
