#include <gmock/gmock.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <set>

#include "tests/unit/server/store/store_fixture.h"

namespace cairn::server {
namespace {

/// Transaction n: one block of its own, one tile that every transaction replaces, a note.
Transaction numbered(std::uint32_t n) {
  Transaction transaction;
  transaction.submaps = {sample_submap(1)};
  const BlockKey key{EvidenceLayer::surface, {0, static_cast<std::int32_t>(n), 0}, 3};
  transaction.blocks = {sample_block(transaction.submaps[0].id, key, n)};
  transaction.tiles = {sample_tile({}, n)};
  transaction.notes = {{"last", std::to_string(n)}};
  return transaction;
}

/// What is wrong in a store that acknowledged transactions 1 … `acknowledged`, and may hold one
/// more whose acknowledgement was cut off. Empty: nothing.
std::vector<std::string> faults_of(Store& store, std::uint32_t acknowledged) {
  std::vector<std::string> faults;
  const auto report = store.verify();
  if (!report) return {"verify: " + report.error().message};
  faults = report->faults;
  const auto notes = store.notes();
  const auto blocks = store.blocks_of(sample_submap(1).id);
  if (!notes || !blocks) return {"cannot be read"};
  const auto last = notes->empty() ? 0U : static_cast<std::uint32_t>(std::stoul(notes->at("last")));
  if (last < acknowledged) faults.emplace_back("acknowledged transactions are missing");
  if (last > acknowledged + 1) faults.emplace_back("transactions nobody made");
  std::set<std::int32_t> there;
  for (const BlockRow& row : *blocks) {
    if (!there.insert(row.key.tile.tx).second) faults.emplace_back("a block is there twice");
    const auto n = static_cast<std::uint32_t>(row.key.tile.tx);
    if (!same(row, numbered(n).blocks[0])) faults.emplace_back("a block has other content");
  }
  for (std::uint32_t n = 1; n <= last; ++n) {
    if (there.erase(static_cast<std::int32_t>(n)) == 0) faults.emplace_back("a block is missing");
  }
  if (!there.empty()) faults.emplace_back("a block of no transaction");
  const auto tiles = store.tiles();
  if (last > 0 && (!tiles || tiles->size() != 1 || !same((*tiles)[0], sample_tile({}, last)))) {
    faults.emplace_back("the tile is not of the last transaction");
  }
  return faults;
}

/// Commits from `first` on for ever, writing a byte for each transaction that is durable.
[[noreturn]] void commit_for_ever(const std::filesystem::path& file, std::uint32_t first,
                                  int acknowledge) {
  auto store = SqliteStore::open(file);
  if (!store) _exit(1);
  for (std::uint32_t n = first;; ++n) {
    if (!(*store)->commit(numbered(n))) _exit(2);
    const char byte = 'a';
    if (write(acknowledge, &byte, 1) != 1) _exit(3);
  }
}

/// Lets a child commit until `patience` after its first acknowledgement, kills it without warning,
/// and returns how many transactions it acknowledged.
std::uint32_t commit_and_kill(const std::filesystem::path& file, std::uint32_t first,
                              std::chrono::microseconds patience) {
  int acks[2];
  EXPECT_EQ(pipe(acks), 0);
  const pid_t child = fork();
  if (child == 0) commit_for_ever(file, first, acks[1]);
  close(acks[1]);
  pollfd started{acks[0], POLLIN, 0};
  EXPECT_EQ(poll(&started, 1, 10'000), 1);
  usleep(static_cast<useconds_t>(patience.count()));
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << "the child gave up by itself: " << WEXITSTATUS(status);
  std::uint32_t count = 0;
  char buffer[4096];
  for (ssize_t got = 0; (got = read(acks[0], buffer, sizeof buffer)) > 0;) {
    count += static_cast<std::uint32_t>(got);
  }
  close(acks[0]);
  return count;
}

class Kill : public StoreTest {};

TEST_F(Kill, NineAtAnyMomentLosesNothingThatWasAcknowledged) {
  const auto seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  (void)found();
  std::uint32_t last = 0;
  for (int round = 0; round < 25; ++round) {
    last += commit_and_kill(file_, last + 1, std::chrono::microseconds(random() % 150'000));
    const auto store = reopen();
    EXPECT_THAT(faults_of(*store, last), testing::IsEmpty()) << "round " << round;
    const auto notes = store->notes();
    ASSERT_TRUE(notes && notes->contains("last"));
    last = static_cast<std::uint32_t>(std::stoul(notes->at("last")));
  }
  EXPECT_GT(last, 25U);
  RecordProperty("transactions", static_cast<int>(last));
}

TEST_F(Kill, NineIsNoticedWhenItDoesLoseSomething) {
  (void)found();
  const std::uint32_t last =
      commit_and_kill(file_, 1, std::chrono::microseconds(std::chrono::milliseconds(30)));
  ASSERT_GT(last, 1U);
  ASSERT_THAT(faults_of(*reopen(), last), testing::IsEmpty());
  tamper(file_, "DELETE FROM block WHERE tile = (SELECT min(tile) FROM block)");
  EXPECT_THAT(faults_of(*reopen(), last), testing::Contains("a block is missing"));
}

}  // namespace
}  // namespace cairn::server
