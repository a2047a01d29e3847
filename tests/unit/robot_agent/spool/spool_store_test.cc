#include "robot_agent/spool/spool_store.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <numeric>

#include "tests/support/process.h"
#include "tests/unit/robot_agent/spool/samples.h"

namespace cairn::agent {
namespace {

using testing::kOwner;
using testing::same;
using testing::sample;
namespace fs = std::filesystem;

/// No file may grow beyond so many bytes, as on a disk that is full.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

class SpoolStoreTest : public ::testing::Test {
 protected:
  void open(std::uint64_t most_bytes = 1U << 30U) {
    store.reset();
    auto opened = SpoolStore::open({folder(), most_bytes, kOwner, {}});
    ASSERT_TRUE(opened) << opened.error().message;
    store = std::move(*opened);
  }
  [[nodiscard]] fs::path folder() const { return temp.path() / "spool"; }
  [[nodiscard]] std::vector<fs::path> files() const {
    std::vector<fs::path> all;
    for (const auto& file : fs::directory_iterator(folder())) {
      if (file.path().extension() == SpoolFolder::kSuffix) all.push_back(file.path());
    }
    return all;
  }
  [[nodiscard]] std::uint64_t bytes_on_disk() const {
    const auto all = files();
    return std::accumulate(
        all.begin(), all.end(), std::uint64_t{0},
        [](std::uint64_t sum, const fs::path& file) { return sum + fs::file_size(file); });
  }
  Status save(SubmapId id) { return store->save(sample(id), went); }

  test::TempFolder temp;
  std::unique_ptr<SpoolStore> store;
  SpoolStore::Thinned went;
};

TEST_F(SpoolStoreTest, HoldsWhatWasSavedAcrossARestartOldestFirst) {
  open();
  for (const SubmapId id : {SubmapId{9, 1}, SubmapId{9, 2}, SubmapId{4, 1}}) ASSERT_TRUE(save(id));
  open();
  EXPECT_EQ(store->oldest_first(), (std::vector<SubmapId>{{9, 1}, {9, 2}, {4, 1}}));
  EXPECT_EQ(store->bytes(), bytes_on_disk());
  for (const SubmapId& id : store->oldest_first()) {
    const auto loaded = store->load(id);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_TRUE(same(*loaded, sample(id)));
  }
}

TEST_F(SpoolStoreTest, ReplacesASubmapThatIsSavedAgainAndForgetsOneThatIsRemoved) {
  open();
  ASSERT_TRUE(store->save(sample({9, 1}, 10), went));
  ASSERT_TRUE(store->save(sample({9, 1}, 60), went));
  EXPECT_TRUE(same(*store->load({9, 1}), sample({9, 1}, 60)));
  EXPECT_EQ(files().size(), 1U);
  EXPECT_EQ(store->bytes(), bytes_on_disk());
  ASSERT_TRUE(store->remove({9, 1}));
  EXPECT_TRUE(files().empty());
  EXPECT_EQ(store->bytes(), 0U);
}

TEST_F(SpoolStoreTest, ThinsTheOldestFirstAndThenDropsThemAndNeverPassesItsBound) {
  open();
  ASSERT_TRUE(save({9, 1}));
  const std::uint64_t one = store->bytes();
  const std::uint64_t bound = one * 4 + one / 2;
  open(bound);
  for (std::uint32_t sequence = 2; sequence <= 4; ++sequence) ASSERT_TRUE(save({9, sequence}));
  EXPECT_TRUE(went.thinned.empty());
  ASSERT_TRUE(save({9, 5}));
  EXPECT_EQ(went.thinned, (std::vector<SubmapId>{{9, 1}, {9, 2}}));
  EXPECT_TRUE(went.dropped.empty());
  for (std::uint32_t sequence = 6; sequence <= 12; ++sequence) {
    ASSERT_TRUE(save({9, sequence}));
    EXPECT_LE(bytes_on_disk(), bound);
    EXPECT_EQ(store->bytes(), bytes_on_disk());
  }
  ASSERT_FALSE(went.dropped.empty());
  EXPECT_EQ(went.dropped[0], (SubmapId{9, 1}));
  EXPECT_EQ(store->submaps() + went.dropped.size(), 12U);
  EXPECT_TRUE(same(*store->load({9, 12}), sample({9, 12})));
}

TEST_F(SpoolStoreTest, RefusesASubmapLargerThanItsBound) {
  open(1000);
  const Status saved = save({9, 1});
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().code, ErrorCode::exhausted);
}

TEST_F(SpoolStoreTest, KeepsTheOlderStateWhenTheDiskIsFull) {
  open();
  ASSERT_TRUE(store->save(sample({9, 1}, 10), went));
  {
    const FileLimit limit(1000);
    const Status saved = store->save(sample({9, 1}, 100), went);
    ASSERT_FALSE(saved);
    EXPECT_EQ(saved.error().code, ErrorCode::io);
    EXPECT_NE(saved.error().message.find("cannot write"), std::string::npos);
  }
  EXPECT_TRUE(same(*store->load({9, 1}), sample({9, 1}, 10)));
  EXPECT_TRUE(store->save(sample({9, 1}, 100), went));
  open();
  EXPECT_TRUE(same(*store->load({9, 1}), sample({9, 1}, 100)));
}

TEST_F(SpoolStoreTest, SetsAsideWhatIsDamagedOrAnothersAndSaysWhere) {
  open();
  ASSERT_TRUE(save({9, 1}));
  std::fstream(files().at(0), std::ios::in | std::ios::out | std::ios::binary).seekp(30).put('x');
  const auto damaged = store->load({9, 1});
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().message.find("set aside in aside/"), std::string::npos);
  EXPECT_EQ(store->submaps(), 0U);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder() / "aside"), fs::directory_iterator()), 1);

  ASSERT_TRUE(save({9, 2}));
  store.reset();
  auto other = SpoolStore::open({folder(), 1U << 30U, {"r2", "lab", 125}, {}});
  ASSERT_TRUE(other);
  const auto foreign = (*other)->load({9, 2});
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, ErrorCode::conflict);
}

TEST_F(SpoolStoreTest, DeliversNothingUnderAnotherName) {
  open();
  ASSERT_TRUE(save({9, 1}));
  fs::rename(files().at(0), folder() / "0000000000000007-0000000000000008-00000003.submap");
  open();
  ASSERT_TRUE(store->contains({8, 3}));
  EXPECT_FALSE(store->load({8, 3}));
}

TEST_F(SpoolStoreTest, IgnoresFilesThatAreNotItsOwnAndWhatWasHalfWritten) {
  open();
  ASSERT_TRUE(save({9, 1}));
  std::ofstream(folder() / "notes.txt") << "mine";
  std::ofstream(folder() / "1-2-3.submap") << "not quite";
  std::ofstream(folder() / "half-written") << "half";
  open();
  EXPECT_EQ(store->submaps(), 1U);
  EXPECT_TRUE(fs::exists(folder() / "notes.txt"));
  EXPECT_FALSE(fs::exists(folder() / "half-written"));
}

TEST_F(SpoolStoreTest, IsOneAgentsAtATime) {
  open();
  const auto second = SpoolStore::open({folder(), 1U << 30U, kOwner, {}});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::conflict);
}

}  // namespace
}  // namespace cairn::agent
