#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "server/api/limits.h"

namespace cairn::server {

/// Who is connected: bounds their number, and closes them all at the end. Thread-safe.
class Connections : public std::enable_shared_from_this<Connections> {
 public:
  /// A place among the connections, given back when destroyed.
  class Place {
   public:
    Place(std::shared_ptr<Connections> connections, std::uint64_t id)
        : connections_(std::move(connections)), id_(id) {}
    ~Place() { connections_->leave(id_); }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

    /// How to close the connection, callable from any thread; called at once when all are closed.
    void on_close_all(std::function<void()> close) {
      connections_->on_close_all(id_, std::move(close));
    }

   private:
    std::shared_ptr<Connections> connections_;
    std::uint64_t id_;
  };

  /// Null when there are kMaxConnections, or after close_all().
  [[nodiscard]] std::unique_ptr<Place> enter() {
    const std::lock_guard lock(mutex_);
    if (closed_ || close_.size() >= kMaxConnections) {
      ++refused_;
      return nullptr;
    }
    close_.emplace(++last_id_, nullptr);
    return std::make_unique<Place>(shared_from_this(), last_id_);
  }

  void close_all() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    for (const auto& [id, close] : close_) {
      if (close) close();
    }
  }

  [[nodiscard]] std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return close_.size();
  }
  [[nodiscard]] std::uint64_t refused() const {
    const std::lock_guard lock(mutex_);
    return refused_;
  }

 private:
  void leave(std::uint64_t id) {
    const std::lock_guard lock(mutex_);
    close_.erase(id);
  }
  void on_close_all(std::uint64_t id, std::function<void()> close) {
    const std::lock_guard lock(mutex_);
    if (closed_) close();
    close_[id] = std::move(close);
  }

  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, std::function<void()>> close_;
  std::uint64_t last_id_ = 0;
  std::uint64_t refused_ = 0;
  bool closed_ = false;
};

}  // namespace cairn::server
