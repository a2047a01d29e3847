#include "proto/udp/robot_end.h"

#include <algorithm>
#include <utility>

#include "proto/udp/keys.h"

namespace cairn::proto {
namespace {

std::uint32_t random_name() { return randombytes_random(); }

Error setting_up() {
  return {ErrorCode::unavailable, "a session with the server is being set up: frames wait"};
}

}  // namespace

UdpRobotEnd::UdpRobotEnd(const Secret& key, std::uint64_t first_stamp)
    : key_(key), key_id_(key_id(key)), agent_(random_name()), next_stamp_(first_stamp) {}

// ---- What is sent -------------------------------------------------------------------------------

Status UdpRobotEnd::send(std::span<const std::uint8_t> frame, MonotonicTime now) {
  const bool greeting = is_greeting(frame);
  const bool rides = greeting && (!current_ || now - heard_at_ > kQuiet);
  if (rides && (!attempt_ || attempt_->greeting.empty())) {
    begin(Cause::need, {frame.begin(), frame.end()}, now);
    return {};
  }
  if (rides) return setting_up();
  if (!current_) {
    if (!attempt_) begin(Cause::need, {}, now);
    return setting_up();
  }
  confirm_due_.reset();
  queue(current_->seal(frame));
  return {};
}

void UdpRobotEnd::begin(Cause cause, UdpBytes greeting, MonotonicTime now) {
  const UdpBytes head = first_head(key_id_);
  NoiseHandshake handshake(key_, head, Secret::random());
  const std::uint32_t session = random_name();
  const UdpBytes sealed = handshake.write_first(encode(FirstPayload{
      .stamp = next_stamp_++, .session = session, .agent = agent_, .greeting = greeting}));
  UdpBytes packet = head;
  packet.insert(packet.end(), sealed.begin(), sealed.end());
  const Duration wait =
      round_trip_ ? std::clamp(2 * *round_trip_, kLeastWait, kMostWait) : kFirstWait;
  attempt_.emplace(Attempt{.cause = cause,
                           .session = session,
                           .greeting = std::move(greeting),
                           .handshake = handshake,
                           .packet = std::move(packet),
                           .begun = now,
                           .due = now,
                           .wait = wait});
}

/// The same packet each time: whichever copy is answered, the answer fits.
void UdpRobotEnd::transmit_attempt(MonotonicTime now) {
  ++attempt_->tries;
  attempt_->due = now + attempt_->wait;
  const bool hopeful = now - attempt_->begun < kHopeful;
  attempt_->wait = hopeful ? std::min(attempt_->wait * 3 / 2, kMostWait) : kPatientWait;
  queue(attempt_->packet);
}

void UdpRobotEnd::queue(UdpBytes packet) {
  if (outbox_.size() >= kMaxQueued) outbox_.pop_front();
  outbox_.push_back(std::move(packet));
}

std::optional<UdpBytes> UdpRobotEnd::next_packet(MonotonicTime now) {
  if (current_ && !attempt_ && now - session_begun_ >= kMaxAge) begin(Cause::age, {}, now);
  if (attempt_ && now >= attempt_->due) transmit_attempt(now);
  if (current_ && confirm_due_ && now >= *confirm_due_) {
    confirm_due_.reset();
    queue(current_->seal({}));
  }
  if (outbox_.empty()) return std::nullopt;
  UdpBytes packet = std::move(outbox_.front());
  outbox_.pop_front();
  return packet;
}

MonotonicTime UdpRobotEnd::next_due(MonotonicTime now) const {
  if (!outbox_.empty()) return now;
  MonotonicTime due = now + kMaxAge;
  if (attempt_) due = std::min(due, attempt_->due);
  if (confirm_due_) due = std::min(due, *confirm_due_);
  if (current_ && !attempt_) due = std::min(due, session_begun_ + kMaxAge);
  return std::max(due, now);
}

// ---- What arrives -------------------------------------------------------------------------------

std::optional<UdpBytes> UdpRobotEnd::on_packet(std::span<const std::uint8_t> packet,
                                               MonotonicTime now) {
  const auto type = packet_type(packet);
  if (!type || !named_session(packet)) return refuse();
  if (*type == PacketType::second) return on_second(packet, now);
  if (is_data(packet)) return on_data(packet, now);
  if (*type == PacketType::stale) on_stale(packet, now);
  if (*type == PacketType::unknown) on_unknown(packet, now);
  return std::nullopt;
}

std::optional<UdpBytes> UdpRobotEnd::refuse() {
  ++refused_;
  return std::nullopt;
}

std::optional<UdpBytes> UdpRobotEnd::on_second(std::span<const std::uint8_t> packet,
                                               MonotonicTime now) {
  if (!attempt_ || named_session(packet) != attempt_->session) return refuse();
  NoiseHandshake handshake = attempt_->handshake;  // A forged answer must not spoil ours.
  const auto opened = handshake.read_second(packet.subspan(kSecondHeadBytes));
  auto payload = opened ? decode_second_payload(*opened) : std::nullopt;
  if (!payload) return refuse();
  const NoiseHandshake::Keys keys = handshake.split();
  previous_ = std::move(current_);
  current_.emplace(attempt_->session, payload->session, keys.from_initiator, keys.from_responder);
  // Sent more than once, it is not known which copy was answered (Karn's rule).
  if (attempt_->tries == 1) round_trip_ = now - attempt_->begun;
  attempt_.reset();
  session_begun_ = heard_at_ = now;
  confirm_due_ = now + kConfirmWait;
  if (payload->answer.empty()) return std::nullopt;
  return std::move(payload->answer);
}

/// Our clock went back: the server tells where the stamps stand.
void UdpRobotEnd::on_stale(std::span<const std::uint8_t> packet, MonotonicTime now) {
  const auto stale = decode_stale(packet);
  if (!stale || !attempt_ || stale->robot_session != attempt_->session) return (void)refuse();
  const auto proof = attempt_->handshake.proof(stale_said(stale->newest));
  if (sodium_memcmp(proof.data(), stale->proof.data(), proof.size()) != 0) return (void)refuse();
  next_stamp_ = std::max(next_stamp_, stale->newest + 1);
  begin(attempt_->cause, std::move(attempt_->greeting), now);
}

/// Anybody on the way can say this, so it ends nothing: the session stays in use while another is
/// set up beside it.
void UdpRobotEnd::on_unknown(std::span<const std::uint8_t> packet, MonotonicTime now) {
  if (!current_ || named_session(packet) != current_->peer()) return (void)refuse();
  if (attempt_ || now < hint_from_) return;
  hint_wait_ = now - hint_from_ > 2 * kMostHintWait ? kFirstHintWait
                                                    : std::min(2 * hint_wait_, kMostHintWait);
  hint_from_ = now + hint_wait_;
  begin(Cause::hint, {}, now);
}

std::optional<UdpBytes> UdpRobotEnd::on_data(std::span<const std::uint8_t> packet,
                                             MonotonicTime now) {
  const bool present = current_ && named_session(packet) == current_->own();
  auto& session = present ? current_ : previous_;
  auto opened = session ? session->open(packet) : std::nullopt;
  if (!opened) return refuse();
  heard_at_ = now;
  // The server knows the session after all.
  if (present && attempt_ && attempt_->cause == Cause::hint) attempt_.reset();
  if (opened->frame.empty()) return std::nullopt;
  return std::move(opened->frame);
}

}  // namespace cairn::proto
