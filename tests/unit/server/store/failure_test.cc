#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>

#include "tests/unit/server/store/store_fixture.h"

namespace cairn::server {
namespace {

using testing::HasSubstr;

/// While it lives, no file of this process may grow beyond `bytes`: as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : on_signal_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    (void)signal(SIGXFSZ, on_signal_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  sighandler_t on_signal_;
};

Transaction numbered(std::uint32_t number) {
  const SubmapRow submap = sample_submap(number);
  Transaction transaction;
  transaction.submaps = {submap};
  for (std::uint8_t block = 0; block < kBlocksPerTile; ++block) {
    transaction.blocks.push_back(
        sample_block(submap.id, {EvidenceLayer::surface, {}, block}, number));
  }
  transaction.notes = {{"last", std::to_string(number)}};
  return transaction;
}

void expect_exactly(Store& store, std::uint32_t transactions) {
  const auto submaps = store.submaps();
  ASSERT_TRUE(submaps) << submaps.error().message;
  EXPECT_EQ(submaps->size(), transactions);
  for (const SubmapRow& submap : *submaps) {
    const auto blocks = store.blocks_of(submap.id);
    ASSERT_TRUE(blocks) << blocks.error().message;
    EXPECT_EQ(blocks->size(), std::size_t{kBlocksPerTile});
  }
  EXPECT_EQ(store.notes()->at("last"), std::to_string(transactions));
  EXPECT_THAT(store.verify()->faults, testing::IsEmpty());
}

class Failure : public StoreTest {};

TEST_F(Failure, AFullDiskRefusesCommitsWholeAndTheStoreGoesOnOnceThereIsRoom) {
  const auto store = found();
  std::uint32_t kept = 0;
  for (int round = 0; round < 3; ++round) {
    {
      const FullDisk full(100'000 + 300'000 * static_cast<rlim_t>(round));
      Status done;
      while ((done = store->commit(numbered(kept + 1)))) ASSERT_LT(++kept, 1000U);
      EXPECT_EQ(done.error().code, ErrorCode::io);
      EXPECT_THAT(done.error().message, HasSubstr("nothing of this step was kept"));
      EXPECT_FALSE(store->commit(numbered(kept + 1))) << "still full";
      expect_exactly(*store, kept);
    }
    commit(*store, numbered(++kept));
    expect_exactly(*store, kept);
  }
}

TEST_F(Failure, WhatWasAcknowledgedOnAFullDiskIsThereAfterReopening) {
  std::uint32_t kept = 0;
  {
    const auto store = found();
    const FullDisk full(200'000);
    while (store->commit(numbered(kept + 1))) ASSERT_LT(++kept, 1000U);
  }
  ASSERT_GT(kept, 0U);
  expect_exactly(*reopen(), kept);
}

TEST_F(Failure, FoundingOnAFullDiskLeavesNothingBehind) {
  {
    const FullDisk full(6000);
    const auto store = SqliteStore::create(file_, sample_site());
    ASSERT_FALSE(store);
    EXPECT_EQ(store.error().code, ErrorCode::io);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  EXPECT_TRUE(SqliteStore::create(file_, sample_site()));
}

}  // namespace
}  // namespace cairn::server
