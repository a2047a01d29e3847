#include "server/link/hub.h"

#include <spdlog/spdlog.h>

#include <boost/asio/post.hpp>
#include <chrono>
#include <utility>
#include <variant>

#include "proto/codec/frame.h"

namespace cairn::server {

namespace asio = boost::asio;

Hub::Hub(Strand strand, std::vector<std::unique_ptr<proto::Carrier>> carriers, Listener listener,
         const proto::BudgetConfig& budget)
    : strand_(std::move(strand)),
      carriers_(std::move(carriers)),
      listener_(std::move(listener)),
      budget_(budget),
      timer_(strand_) {}

MonotonicTime Hub::now() {
  return std::chrono::duration_cast<MonotonicTime>(
      std::chrono::steady_clock::now().time_since_epoch());
}

void Hub::start() {
  asio::post(strand_, [self = shared_from_this()] {
    self->running_ = true;
    self->tick();
  });
  for (std::size_t i = 0; i < carriers_.size(); ++i) {
    threads_.emplace_back([this, i](const std::stop_token& stop) { receive(i, stop); });
  }
}

void Hub::stop() {
  threads_.clear();  // Asks each to stop and joins it.
  asio::post(strand_, [self = shared_from_this()] {
    self->running_ = false;
    self->timer_.cancel();
  });
}

void Hub::receive(std::size_t carrier, const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    auto received = carriers_[carrier]->receive(std::chrono::milliseconds(100));
    if (!received) {
      spdlog::error("link: {}", received.error().message);
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      continue;
    }
    if (!received->has_value()) continue;
    if (queued_.load(std::memory_order_relaxed) >= kMaxQueued) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      continue;
    }
    queued_.fetch_add(1, std::memory_order_relaxed);
    asio::post(strand_,
               [this, keep = shared_from_this(), carrier, datagram = std::move(**received)] {
                 queued_.fetch_sub(1, std::memory_order_relaxed);
                 take(carrier, datagram);
               });
  }
}

void Hub::take(std::size_t carrier, const proto::Datagram& datagram) {
  const Result<proto::Frame> frame = proto::decode_frame(datagram.bytes, proto::Direction::up);
  if (!frame) {
    spdlog::debug("link: frame from {}: {}", datagram.peer, frame.error().message);
    const auto proven = carriers_[carrier]->proven_robot(datagram.peer);
    Robot* robot = proven ? find(*proven) : nullptr;
    if (robot != nullptr) ++robot->frames_malformed;
    return;
  }
  if (frame->header.session == 0) {
    for (const proto::Record& record : frame->records) {
      if (const auto* hello = std::get_if<proto::Hello>(&record)) {
        take_hello(carrier, datagram.peer, *hello);
      }
    }
    return;
  }
  const auto session = sessions_.find(frame->header.session);
  Robot* robot = session == sessions_.end() ? nullptr : find(session->second);
  if (robot == nullptr || robot->carrier != carrier || robot->peer != datagram.peer) {
    answer(carrier, datagram.peer, frame->header.session, proto::Reset{});
    return;
  }
  take_events(*robot, robot->link->on_frame(*frame, datagram.bytes.size(), now()));
}

std::optional<proto::Reject> Hub::refuse(std::size_t carrier, const std::string& peer,
                                         const proto::Hello& hello,
                                         const std::shared_ptr<Site>& site) {
  const auto reject = [&](proto::RejectReason reason, std::string text) {
    spdlog::warn("robot {}: refused: {}", hello.robot, text);
    return proto::Reject{hello.boot, reason, std::move(text)};
  };
  if (const auto proven = carriers_[carrier]->proven_robot(peer);
      proven && hello.robot != *proven) {
    return reject(
        proto::RejectReason::bad_name,
        fmt::format("the key is robot '{}''s, not '{}''s: start the agent with --robot {}", *proven,
                    hello.robot, *proven));
  }
  if (!site) {
    return reject(proto::RejectReason::unknown_site,
                  fmt::format("no site '{0}' here: found it with `cairn found {0}`", hello.site));
  }
  if (const int cell = site->info().cell_size_mm; cell != hello.cell_size_mm) {
    return reject(proto::RejectReason::cell_size_differs,
                  fmt::format("site '{}' has cells of {} mm, the robot {} mm: start the agent with "
                              "--cell-mm {}",
                              hello.site, cell, hello.cell_size_mm, cell));
  }
  Robot* known = find(hello.robot);
  if (known == nullptr && robots_.size() >= kMaxRobots) {
    return reject(proto::RejectReason::server_full,
                  fmt::format("the server already knows {} robots, its limit", kMaxRobots));
  }
  if (known != nullptr && known->link && known->link->boot() != hello.boot &&
      keeps_its_id(*known)) {
    return reject(proto::RejectReason::robot_id_in_use,
                  fmt::format("robot id '{}' is in use by a running agent: give this one another "
                              "--robot",
                              hello.robot));
  }
  return std::nullopt;
}

bool Hub::keeps_its_id(Robot& robot) {
  // A session in which nothing was ever said may have been begun by a Hello of long ago.
  if (robot.link->counters().frames_received == 0) return false;
  const MonotonicTime time = now();
  const Duration silence = robot.link->silence(time);
  if (silence < Robot::kPresence) return true;
  if (!robot.present(time)) return false;
  if (!robot.probed_at || *robot.probed_at < time - silence) {
    robot.probed_at = time;
    robot.link->welcome_again();
    pump(robot);
  }
  return time - *robot.probed_at < Robot::kProbeWait;
}

void Hub::take_hello(std::size_t carrier, const std::string& peer, const proto::Hello& hello) {
  if (Robot* known = find(hello.robot);
      known != nullptr && known->link && known->link->boot() == hello.boot && known->peer == peer &&
      known->carrier == carrier && known->site->info().name == hello.site) {
    known->link->welcome_again();
    pump(*known);
    return;
  }
  std::shared_ptr<Site> site = listener_.site_named(hello.site);
  if (const auto reject = refuse(carrier, peer, hello, site)) {
    answer(carrier, peer, 0, *reject);
    return;
  }
  open_session(carrier, peer, hello, std::move(site));
}

void Hub::open_session(std::size_t carrier, const std::string& peer, const proto::Hello& hello,
                       std::shared_ptr<Site> site) {
  std::uint32_t session = 0;
  while (session == 0 || sessions_.contains(session)) {
    session = static_cast<std::uint32_t>(random_());
  }
  Robot& robot = robots_[hello.robot];
  if (robot.link) sessions_.erase(robot.link->session());
  sessions_[session] = hello.robot;
  robot.id = hello.robot;
  robot.carrier = carrier;
  robot.peer = peer;
  robot.pose_of_session = false;
  robot.spool.reset();
  robot.probed_at.reset();
  robot.site = std::move(site);
  robot.link =
      std::make_unique<proto::ServerLink>(session, hello, robot.site->info().epoch,
                                          carriers_[carrier]->overhead_bytes(), now(), budget_);
  robot.downlink = {};
  spdlog::info("robot {}: session on site {}", robot.id, hello.site);
  listener_.connected(robot);
  pump(robot);
}

void Hub::take_events(Robot& robot, std::vector<proto::ServerLink::Event> events) {
  for (proto::ServerLink::Event& event : events) {
    if (const auto* pose = std::get_if<proto::PoseReport>(&event)) {
      if (!robot.pose_of_session) spdlog::info("robot {}: first pose", robot.id);
      robot.take_pose(*pose, now());
    } else if (const auto* spool = std::get_if<proto::SpoolReport>(&event)) {
      robot.spool = *spool;
    } else if (const auto* report = std::get_if<proto::CommandReport>(&event)) {
      listener_.reported(robot, *report);
    } else if (const auto* digest = std::get_if<proto::MapDigest>(&event)) {
      compare(robot, *digest);
    } else if (const auto* request = std::get_if<proto::CorridorRequest>(&event)) {
      listener_.asked(robot, *request);
    } else if (auto* evidence = std::get_if<proto::ServerLink::Evidence>(&event)) {
      submit(robot, std::move(*evidence));
    } else if (std::holds_alternative<proto::Bye>(event)) {
      spdlog::info("robot {}: session ended", robot.id);
    }
  }
  pump(robot);
}

void Hub::submit(Robot& robot, proto::ServerLink::Evidence evidence) {
  const std::uint32_t session = robot.link->session();
  const std::uint32_t number = evidence.number;
  robot.site->submit(robot.id, robot.link->boot(), std::move(evidence),
                     [self = shared_from_this(), session, number](Site::Outcome outcome) {
                       asio::post(self->strand_,
                                  [self, session, number, outcome = std::move(outcome)] {
                                    self->settle(session, number, outcome);
                                  });
                     });
}

void Hub::compare(Robot& robot, const proto::MapDigest& digest) {
  robot.downlink.hear(digest, now());
  const std::uint32_t session = robot.link->session();
  robot.site->compare(robot.link->boot(), digest,
                      [self = shared_from_this(), session](std::vector<ComparedTile> compared) {
                        asio::post(self->strand_, [self, session, compared = std::move(compared)] {
                          const auto found = self->sessions_.find(session);
                          if (found != self->sessions_.end()) {
                            self->robots_.at(found->second).downlink.take(compared);
                          }
                        });
                      });
}

void Hub::settle(std::uint32_t session, std::uint32_t number, const Site::Outcome& outcome) {
  const auto found = sessions_.find(session);
  if (found == sessions_.end()) return;  // Another session by now; the robot will ask again.
  Robot& robot = robots_.at(found->second);
  for (const proto::Refusal& refusal : outcome.refusals) robot.link->refuse(refusal);
  // A frame of which something was refused is never acknowledged, so that the robot sends it again.
  if (outcome.durable && outcome.refusals.empty()) robot.link->durable(number);
}

void Hub::answer(std::size_t carrier, const std::string& peer, std::uint32_t session,
                 const proto::Record& record) {
  proto::FrameWriter frame({proto::Direction::down, session, 0});
  frame.add(record);
  if (Status sent = carriers_[carrier]->send({peer, std::move(frame).finish()}); !sent) {
    spdlog::debug("link: to {}: {}", peer, sent.error().message);
  }
}

void Hub::command(Robot& robot, const proto::Command& command,
                  const std::vector<std::uint8_t>& path, Duration expires_in) {
  robot.link->command(command, path, expires_in, now());
  pump(robot);
}

void Hub::corridor(Robot& robot, std::vector<proto::CorridorPart> parts) {
  for (proto::CorridorPart& part : parts) robot.link->corridor(std::move(part));
  pump(robot);
}

Robot* Hub::find(const std::string& robot) {
  const auto found = robots_.find(robot);
  return found == robots_.end() ? nullptr : &found->second;
}

void Hub::pump(Robot& robot) {
  while (auto bytes = robot.link->next_frame(now())) {
    if (Status sent = carriers_[robot.carrier]->send({robot.peer, std::move(*bytes)}); !sent) {
      spdlog::debug("link: to {}: {}", robot.id, sent.error().message);
      return;
    }
  }
}

void Hub::tell_of_map(Robot& robot) {
  if (!robot.pose_of_session || !robot.downlink.should_ask(*robot.link, now())) return;
  const std::uint32_t session = robot.link->session();
  const MapNeed need{robot.link->boot(), robot.x_m(), robot.y_m()};
  robot.site->offer(need, robot.downlink.told(),
                    [self = shared_from_this(), session](PreparedOffer prepared) {
                      asio::post(self->strand_, [self, session, prepared = std::move(prepared)] {
                        const auto found = self->sessions_.find(session);
                        if (found == self->sessions_.end()) return;
                        Robot& asked = self->robots_.at(found->second);
                        asked.downlink.take(prepared, *asked.link);
                        self->pump(asked);
                      });
                    });
}

void Hub::tick() {
  if (!running_) return;
  for (auto& [id, robot] : robots_) {
    if (robot.link && robot.present(now())) tell_of_map(robot);
    if (robot.link && robot.link->next_due(now()) <= now()) pump(robot);
  }
  timer_.expires_after(kTick);
  timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
    if (!error) self->tick();
  });
}

}  // namespace cairn::server
