#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "core/common/time.h"
#include "proto/carrier.h"
#include "proto/sync/server_link.h"
#include "server/link/robots.h"

namespace cairn::server {

/// Every robot's session: takes frames from the carriers, hands evidence to the sites and what
/// robots report to the mission, and sends what is due. Lives on the control strand: all functions
/// but the constructor, `start` and `stop` must be called there.
class Hub : public std::enable_shared_from_this<Hub> {
 public:
  using Strand = boost::asio::strand<boost::asio::any_io_executor>;

  /// Who wants to hear of robots. Called on the control strand.
  struct Listener {
    /// A robot opened a session.
    std::function<void(Robot&)> connected;
    std::function<void(Robot&, const proto::CommandReport&)> reported;
    /// A robot asks for more of its field, or a new plan.
    std::function<void(Robot&, const proto::CorridorRequest&)> asked;
    /// The site of that name; null when there is none.
    std::function<std::shared_ptr<Site>(const std::string&)> site_named;
  };

  /// `budget`: of each robot's way down.
  Hub(Strand strand, std::vector<std::unique_ptr<proto::Carrier>> carriers, Listener listener,
      const proto::BudgetConfig& budget = {});

  /// Begins to receive and send.
  void start();
  /// Stops the receiving threads and timers; returns when they have ended.
  void stop();

  /// Sends a command and its coded path to a robot, over and over until the robot reports on it.
  void command(Robot& robot, const proto::Command& command, const std::vector<std::uint8_t>& path,
               Duration expires_in);

  /// Of the command's present revision; goes after it.
  void corridor(Robot& robot, std::vector<proto::CorridorPart> parts);

  /// Null when no such robot was ever seen.
  [[nodiscard]] Robot* find(const std::string& robot);
  [[nodiscard]] std::map<std::string, Robot>& robots() { return robots_; }
  [[nodiscard]] static MonotonicTime now();

  /// [robots] Known at once.
  static constexpr std::size_t kMaxRobots = 256;
  /// How often every session is asked for what is due.
  static constexpr std::chrono::milliseconds kTick{15};
  /// [frames] Received and not yet handled; beyond it frames are dropped, as a full socket would.
  static constexpr int kMaxQueued = 4'096;

 private:
  void receive(std::size_t carrier, const std::stop_token& stop);
  void take(std::size_t carrier, const proto::Datagram& datagram);
  void take_hello(std::size_t carrier, const std::string& peer, const proto::Hello& hello);
  std::optional<proto::Reject> refuse(std::size_t carrier, const std::string& peer,
                                      const proto::Hello& hello, const std::shared_ptr<Site>& site);
  /// Whether the robot is there and keeps its id against a newcomer. One that only stands is asked.
  bool keeps_its_id(Robot& robot);
  void open_session(std::size_t carrier, const std::string& peer, const proto::Hello& hello,
                    std::shared_ptr<Site> site);
  void take_events(Robot& robot, std::vector<proto::ServerLink::Event> events);
  void submit(Robot& robot, proto::ServerLink::Evidence evidence);
  void compare(Robot& robot, const proto::MapDigest& digest);
  void settle(std::uint32_t session, std::uint32_t number, const Site::Outcome& outcome);
  void answer(std::size_t carrier, const std::string& peer, std::uint32_t session,
              const proto::Record& record);
  /// Asks the site what the robot should know of its map, now and then.
  void tell_of_map(Robot& robot);
  void pump(Robot& robot);
  void tick();

  Strand strand_;
  std::vector<std::unique_ptr<proto::Carrier>> carriers_;
  Listener listener_;
  proto::BudgetConfig budget_;
  boost::asio::steady_timer timer_;
  std::map<std::string, Robot> robots_;
  std::unordered_map<std::uint32_t, std::string> sessions_;  ///< session → robot id
  std::mt19937_64 random_{std::random_device{}()};
  std::atomic<int> queued_{0};
  std::atomic<std::uint64_t> dropped_{0};
  bool running_ = false;
  std::vector<std::jthread> threads_;  ///< Last member: they end before the rest goes.
};

}  // namespace cairn::server
