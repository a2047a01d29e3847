#include "tests/support/virtual_server.h"

#include <utility>

#include "server/store/sqlite_store.h"

namespace cairn::test {
namespace {

constexpr Duration kCommitPeriod = std::chrono::milliseconds(12);  ///< As Site's.

}  // namespace

VirtualServer::VirtualServer(std::filesystem::path folder, std::uint64_t seed,
                             std::size_t overhead_bytes)
    : folder_(std::move(folder)), random_(seed), overhead_(overhead_bytes) {
  const server::SiteInfo info{.name = "lab", .epoch = seed + 1, .cell_size_mm = 125};
  (void)server::SqliteStore::create(folder_ / "lab.site", info).value();
  open();
}

void VirtualServer::open() {
  auto store = server::SqliteStore::open(folder_ / "lab.site");
  world_ = server::World::open(std::move(store).value(), SensorModel{}).value();
}

void VirtualServer::restart() {
  link_.reset();
  world_.reset();
  staged_.clear();
  pose_.reset();
  open();
}

void VirtualServer::on_frame(const std::vector<std::uint8_t>& bytes, MonotonicTime now) {
  const auto frame = proto::decode_frame(bytes, proto::Direction::up).value();
  const auto* hello =
      frame.records.empty() ? nullptr : std::get_if<proto::Hello>(&frame.records.front());
  if (hello != nullptr) {
    if (link_ && link_->boot() == hello->boot) return link_->welcome_again();
    link_.emplace(static_cast<std::uint32_t>(random_() | 1U), *hello, world_->site().epoch,
                  overhead_, now);
    downlink_ = {};
    staged_.clear();
    return;
  }
  if (!link_ || link_->session() != frame.header.session) {
    proto::FrameWriter reset({proto::Direction::down, frame.header.session, 0});
    reset.add(proto::Reset{});
    resets_.push_back(std::move(reset).finish());
    return;
  }
  const bool idle = staged_.empty();
  for (auto& event : link_->on_frame(frame, bytes.size(), now)) take(std::move(event), now);
  if (idle && !staged_.empty()) commit_at_ = now + kCommitPeriod;
}

void VirtualServer::take(proto::ServerLink::Event event, MonotonicTime now) {
  if (const auto* pose = std::get_if<proto::PoseReport>(&event)) pose_ = *pose;
  if (const auto* report = std::get_if<proto::CommandReport>(&event)) reports_.push_back(*report);
  if (const auto* digest = std::get_if<proto::MapDigest>(&event)) {
    downlink_.hear(*digest, now);
    downlink_.take(world_->compare(link_->boot(), *digest));
  }
  const auto* evidence = std::get_if<proto::ServerLink::Evidence>(&event);
  if (evidence == nullptr) return;
  auto staged = world_->stage("r1", link_->boot(), *evidence);
  if (staged.accepted) staged_.push_back({evidence->number, std::move(staged.refusals)});
}

void VirtualServer::commit_if_due(MonotonicTime now) {
  if (staged_.empty() || now < commit_at_) return;
  if (!world_->commit()) return;
  for (const Staged& staged : std::exchange(staged_, {})) {
    for (const proto::Refusal& refusal : staged.refusals) link_->refuse(refusal);
    if (staged.refusals.empty()) link_->durable(staged.number);
  }
  (void)world_->take_merged();
}

void VirtualServer::tell_of_map(MonotonicTime now) {
  if (!link_ || !pose_ || !downlink_.should_ask(*link_, now)) return;
  const auto& T_site_robot = pose_->T_site_robot;
  const server::MapNeed need{link_->boot(), T_site_robot.x_mm * 1e-3, T_site_robot.y_mm * 1e-3};
  downlink_.take(world_->offer(need, *downlink_.told()), *link_);
}

std::optional<std::vector<std::uint8_t>> VirtualServer::next_frame(MonotonicTime now) {
  if (!resets_.empty()) {
    auto reset = std::move(resets_.front());
    resets_.pop_front();
    return reset;
  }
  commit_if_due(now);
  tell_of_map(now);
  return link_ ? link_->next_frame(now) : std::nullopt;
}

}  // namespace cairn::test
