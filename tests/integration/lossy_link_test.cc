#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "server/store/sqlite_store.h"
#include "tests/support/emulated_site.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// A robot's log (CARMEN) of a way along a hall of 40 x 8 m with niches, 0.25 m between scans.
void write_hall_log(const std::filesystem::path& file) {
  std::ofstream log(file);
  constexpr int kScans = 80;
  constexpr int kBeams = 181;
  for (int scan = 0; scan < kScans; ++scan) {
    const double x = 0.25 * scan;
    log << "FLASER " << kBeams;
    for (int beam = 0; beam < kBeams; ++beam) {
      const double angle = (beam - 90) * std::numbers::pi / 180.0;
      const double to_end = std::cos(angle) > 1e-6 ? (30.0 - x) / std::cos(angle) : 1e9;
      // Every other 2 m of wall stands back by half a metre.
      const double to_wall = 4.0 / std::max(std::abs(std::sin(angle)), 1e-6);
      const double along = x + to_wall * std::cos(angle);
      const double niche = std::fmod(std::abs(along), 4.0) < 2.0 ? 0.5 : 0.0;
      const double deeper = (4.0 + niche) / std::max(std::abs(std::sin(angle)), 1e-6);
      log << ' ' << std::min({to_end, deeper, 29.0});
    }
    const double time = 0.5 * scan;
    log << ' ' << x << " 0 0 " << x << " 0 0 " << time << " host " << time << '\n';
  }
}

/// The real programs over an emulated radio, on each carrier: a recorded drive is replayed, and the
/// agent ends by itself when the server holds everything.
class LossyLink : public testing::TestWithParam<CarrierKind> {
 protected:
  /// False where there is no emulator.
  bool open(const ChannelConfig& config) {
    auto made = EmulatedSite::create(11, GetParam(), config);
    if (!made) {
      why_not_ = made.error().message;
      return false;
    }
    site_ = std::move(made).value();
    EXPECT_TRUE(site_->start_server()) << site_->server().output();
    EXPECT_EQ(site_->cairn({"found", "hall"}).exit_code, 0);
    const auto log = site_->folder().path() / "hall.clf";
    write_hall_log(log);
    site_->start_agent({"--site", "hall", "--replay", log.string()});
    return true;
  }
  /// The agent's own word is that the server acknowledged all it made at its newest version; a
  /// submap is merged when the server holds all versions that its closing head names; and the audit
  /// folds the map anew from what is held.
  void expect_same_map_at_both_ends(std::chrono::seconds patience) {
    EXPECT_EQ(site_->agent().wait(patience), 0);
    EXPECT_NE(site_->agent().output().find("replayed"), std::string::npos);
    EXPECT_TRUE(eventually([&] { return settled(); }, 30s));
    site_->server().kill();
    expect_all_merged();
    const Finished checked = audit(site_->folder());
    EXPECT_EQ(checked.exit_code, 0) << checked.output;
    EXPECT_NE(checked.output.find(": sound"), std::string::npos) << checked.output;
    if (HasFailure()) {
      ADD_FAILURE() << site_->link().json() << '\n'
                    << site_->server().output() << site_->agent().output();
    }
  }
  json hall() const {
    const Finished finished = site_->cairn({"status", "--json"});
    const json status = json::parse(finished.output, nullptr, false);
    return status.is_object() ? status["sites"][0] : json::object();
  }
  /// Merging lags a moment behind durability.
  bool settled() {
    const std::uint64_t now = hall().value("submaps_merged", std::uint64_t{0});
    return now > 1 && std::exchange(merged_, now) == now;
  }
  /// But for the one that the robot may have begun at the very end and put nothing into.
  void expect_all_merged() const {
    auto store = server::SqliteStore::open(site_folder(site_->folder()) / "hall.cairn");
    ASSERT_TRUE(store) << store.error().message;
    const auto submaps = (*store)->submaps();
    ASSERT_TRUE(submaps);
    for (const server::SubmapRow& row : *submaps) {
      const auto blocks = (*store)->blocks_of(row.id);
      ASSERT_TRUE(blocks);
      EXPECT_TRUE(row.merge_order > 0 || blocks->empty()) << "submap " << row.id.sequence;
    }
  }

  std::uint64_t merged_ = 0;
  std::unique_ptr<EmulatedSite> site_;
  std::string why_not_;
};

ChannelConfig radio() { return {.rate_bit_s = 200'000, .queue = 2s, .delay = 50ms}; }

TEST_P(LossyLink, BothEndsHoldTheSameMapAfterADriveWithAFifthLostSomeDoubledAndTheOrderTurned) {
  ChannelConfig faulty = radio();
  faulty.loss = 0.2;
  faulty.duplicate = 0.05;
  faulty.jitter = 40ms;
  faulty.reorder = true;
  if (!open(faulty)) GTEST_SKIP() << "skipped: " << why_not_;
  expect_same_map_at_both_ends(150s);
  EXPECT_GT(site_->link().counters().up.lost.packets, 2U);
}

TEST_P(LossyLink, BothEndsHoldTheSameMapAfterWrongBitsBurstsOfLossAnOutageAndAKilledServer) {
  ChannelConfig faulty = radio();
  faulty.bit_error = 1e-5;
  faulty.burst_begin = 0.02;
  faulty.burst_end = 0.25;
  if (!open(faulty)) GTEST_SKIP() << "skipped: " << why_not_;
  ASSERT_TRUE(eventually([&] { return site_->link().counters().up.delivered.bytes > 3'000; }, 90s));
  faulty.outages = {{site_->link().age(), site_->link().age() + 3s}};
  site_->link().set(faulty, faulty);
  site_->server().kill();
  ASSERT_TRUE(site_->start_server()) << site_->server().output();
  expect_same_map_at_both_ends(150s);
}

INSTANTIATE_TEST_SUITE_P(OnEachCarrier, LossyLink,
                         testing::Values(CarrierKind::udp, CarrierKind::dds),
                         [](const auto& each) { return std::string(to_string(each.param)); });

}  // namespace
}  // namespace cairn::test
