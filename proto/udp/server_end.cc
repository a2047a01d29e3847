#include "proto/udp/server_end.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace cairn::proto {

bool AnswerBudget::take(MonotonicTime now) {
  left_ = std::min(kBurst, left_ + kPerSecond * to_seconds(now - std::exchange(at_, now)));
  if (left_ < 1.0) return false;
  left_ -= 1.0;
  return true;
}

std::size_t UdpServerEnd::KeyIdHash::operator()(const KeyId& id) const {
  std::size_t hash = 0;
  for (const std::uint8_t byte : id) hash = (hash << 8U) | byte;  // Already as good as random.
  return hash;
}

std::string UdpPeer::name() const { return robot + '/' + std::to_string(agent); }

UdpPeer UdpPeer::of(const std::string& name) {
  const std::size_t slash = name.find('/');
  UdpPeer peer{.robot = name.substr(0, slash)};
  if (slash != std::string::npos) {
    std::from_chars(name.data() + slash + 1, name.data() + name.size(), peer.agent);
  }
  return peer;
}

UdpServerEnd::UdpServerEnd(const RobotKeys& keys) {
  for (const auto& [id, key] : keys) {
    Robot& robot = robots_[id];
    robot.id = id;
    robot.key = key;
    by_key_[key_id(key)] = &robot;
  }
}

std::optional<Datagram> UdpServerEnd::refuse() {
  ++refused_;
  return std::nullopt;
}

// ---- What arrives -------------------------------------------------------------------------------

std::optional<Datagram> UdpServerEnd::on_packet(std::span<const std::uint8_t> packet,
                                                const Address& from, MonotonicTime now) {
  const auto type = packet_type(packet);
  if (type == PacketType::first) return on_first(packet, from, now);
  if (is_data(packet) && named_session(packet)) return on_data(packet, from, now);
  return refuse();
}

std::optional<Datagram> UdpServerEnd::on_first(std::span<const std::uint8_t> packet,
                                               const Address& from, MonotonicTime now) {
  if (packet.size() < kFirstHeadBytes || packet[1] != kUdpVersion) return refuse();
  KeyId id{};
  std::copy_n(packet.begin() + 2, id.size(), id.begin());
  const auto found = by_key_.find(id);
  if (found == by_key_.end()) return refuse();
  Robot& robot = *found->second;
  NoiseHandshake handshake(robot.key, packet.first(kFirstHeadBytes), Secret::random());
  const auto opened = handshake.read_first(packet.subspan(kFirstHeadBytes));
  const auto payload = opened ? decode_first_payload(*opened) : std::nullopt;
  if (!payload) return refuse();

  // From here on the packet is the robot's own work, though perhaps not sent by it just now.
  if (robot.pending && std::ranges::equal(robot.pending->asked, packet)) {
    repeat_answer(robot, from, now);
    return std::nullopt;
  }
  if (payload->stamp <= robot.newest_stamp) {
    say_stale(robot, handshake, payload->session, from, now);
    return refuse();
  }
  robot.newest_stamp = payload->stamp;
  return begin(robot,
               {.asked = {packet.begin(), packet.end()},
                .at = from,
                .handshake = handshake,
                .name = free_name(),
                .robot_session = payload->session,
                .agent = payload->agent,
                .begun = now},
               payload->greeting, now);
}

std::uint32_t UdpServerEnd::free_name() const {
  std::uint32_t name = randombytes_random();
  while (by_name_.contains(name)) name = randombytes_random();
  return name;
}

std::optional<Datagram> UdpServerEnd::begin(Robot& robot, Pending pending, const UdpBytes& greeting,
                                            MonotonicTime now) {
  if (robot.pending) forget(robot.pending->name);
  robot.pending = std::move(pending);
  by_name_[robot.pending->name] = &robot;
  if (!is_greeting(greeting)) {
    answer(robot, {}, now);
    return std::nullopt;
  }
  if (std::ranges::find(unanswered_, &robot) == unanswered_.end()) unanswered_.push_back(&robot);
  return Datagram{UdpPeer{robot.id, robot.pending->agent}.name(), greeting};
}

void UdpServerEnd::repeat_answer(Robot& robot, const Address& from, MonotonicTime now) {
  Pending& pending = *robot.pending;
  if (!pending.keys || now - pending.answered_at < kRepeatWait) return;
  pending.answered_at = now;
  pending.at = from;
  queue(from, pending.answer);
}

void UdpServerEnd::say_stale(const Robot& robot, const NoiseHandshake& handshake,
                             std::uint32_t robot_session, const Address& to, MonotonicTime now) {
  if (!budget_.take(now)) return;
  queue(to, encode(Stale{.robot_session = robot_session,
                         .newest = robot.newest_stamp,
                         .proof = handshake.proof(stale_said(robot.newest_stamp))}));
}

std::optional<Datagram> UdpServerEnd::on_data(std::span<const std::uint8_t> packet,
                                              const Address& from, MonotonicTime now) {
  const std::uint32_t name = *named_session(packet);
  const auto found = by_name_.find(name);
  if (found == by_name_.end()) {
    if (budget_.take(now)) queue(from, unknown_packet(name));
    return refuse();
  }
  Robot& robot = *found->second;
  const bool confirms = robot.pending && robot.pending->name == name;
  if (confirms && !robot.pending->keys) return refuse();
  const auto session =
      std::ranges::find(robot.sessions, name, [](const Session& s) { return s.keys.own(); });
  UdpSession& keys = confirms ? *robot.pending->keys : session->keys;
  const std::uint32_t agent = confirms ? robot.pending->agent : session->agent;
  auto opened = keys.open(packet);
  if (!opened) return refuse();
  if (confirms) {
    robot.pending->at = from;
    confirm(robot, now);
  } else {
    // The robot has moved; an older packet that was held back must not move it to where it was.
    if (opened->newest) session->at = from;
    session->heard_at = now;
  }
  if (opened->frame.empty()) return std::nullopt;
  return Datagram{UdpPeer{robot.id, agent}.name(), std::move(opened->frame)};
}

void UdpServerEnd::confirm(Robot& robot, MonotonicTime now) {
  Pending pending = *std::exchange(robot.pending, std::nullopt);
  std::vector<Session>& sessions = robot.sessions;
  std::ranges::sort(sessions, std::ranges::greater(), &Session::heard_at);
  while (!sessions.empty() &&
         (sessions.size() >= kMaxSessions || now - sessions.back().heard_at > kLinger)) {
    forget(sessions.back().keys.own());
    sessions.pop_back();
  }
  sessions.push_back({*std::move(pending.keys), pending.agent, pending.at, now});
  for (const UdpBytes& frame : pending.waiting) queue(pending.at, sessions.back().keys.seal(frame));
}

// ---- What is sent -------------------------------------------------------------------------------

UdpServerEnd::Session* UdpServerEnd::newest_session(Robot& robot, std::uint32_t agent) {
  Session* newest = nullptr;
  for (Session& session : robot.sessions) {
    if (session.agent != agent) continue;
    if (newest == nullptr || session.heard_at > newest->heard_at) newest = &session;
  }
  return newest;
}

Status UdpServerEnd::send(const Datagram& frame, MonotonicTime now) {
  const UdpPeer peer = UdpPeer::of(frame.peer);
  const auto found = robots_.find(peer.robot);
  Robot* robot = found == robots_.end() ? nullptr : &found->second;
  Session* session = robot == nullptr ? nullptr : newest_session(*robot, peer.agent);
  const bool pending = robot != nullptr && robot->pending && robot->pending->agent == peer.agent;
  if (session == nullptr && !pending) {
    return Error{ErrorCode::unavailable, "robot '" + peer.robot + "' has no session over UDP"};
  }
  if (pending && !robot->pending->keys) {
    answer(*robot, frame.bytes, now);
    return {};
  }
  if (session != nullptr && (!pending || session->heard_at > robot->pending->begun)) {
    queue(session->at, session->keys.seal(frame.bytes));
    return {};
  }
  std::deque<UdpBytes>& waiting = robot->pending->waiting;
  if (waiting.size() >= kMaxWaiting) waiting.pop_front();
  waiting.push_back(frame.bytes);
  return {};
}

/// Answers the pending set-up; the frame rides along if that stays short, else it waits until the
/// robot has shown that it is where the packet came from.
void UdpServerEnd::answer(Robot& robot, std::span<const std::uint8_t> frame, MonotonicTime now) {
  std::erase(unanswered_, &robot);
  Pending& pending = *robot.pending;
  constexpr std::size_t kRest = kSecondHeadBytes + NoiseHandshake::kMessageBytes + 4;
  const bool rides = frame.size() + kRest <= kMostGrowth * pending.asked.size();
  SecondPayload payload{.session = pending.name, .answer = {}};
  if (rides) payload.answer.assign(frame.begin(), frame.end());
  const auto sealed = pending.handshake.write_second(encode(payload));
  if (!sealed) {  // A degenerate public key: no answer.
    forget(pending.name);
    robot.pending.reset();
    return;
  }
  const NoiseHandshake::Keys keys = pending.handshake.split();
  pending.keys.emplace(pending.name, pending.robot_session, keys.from_responder,
                       keys.from_initiator);
  pending.answer = second_head(pending.robot_session);
  pending.answer.insert(pending.answer.end(), sealed->begin(), sealed->end());
  pending.answered_at = now;
  if (!rides) pending.waiting.emplace_back(frame.begin(), frame.end());
  queue(pending.at, pending.answer);
}

void UdpServerEnd::queue(const Address& to, UdpBytes packet) {
  if (outbox_.size() >= kMaxQueued) outbox_.pop_front();
  outbox_.push_back({to, std::move(packet)});
}

std::optional<UdpServerEnd::Outgoing> UdpServerEnd::next_packet(MonotonicTime now) {
  while (!unanswered_.empty() && now - unanswered_.front()->pending->begun >= kAnswerWait) {
    answer(*unanswered_.front(), {}, now);
  }
  if (outbox_.empty()) return std::nullopt;
  Outgoing first = std::move(outbox_.front());
  outbox_.pop_front();
  return first;
}

MonotonicTime UdpServerEnd::next_due(MonotonicTime now) const {
  if (!outbox_.empty()) return now;
  if (unanswered_.empty()) return now + std::chrono::hours(1);
  return std::max(now, unanswered_.front()->pending->begun + kAnswerWait);
}

}  // namespace cairn::proto
