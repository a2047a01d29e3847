#include "proto/sync/report_board.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

const CommandReport kAccepted{1, 0, CommandState::accepted, ""};
const CommandReport kArrived{1, 0, CommandState::arrived, ""};

std::vector<CommandReport> filled(ReportBoard& board, std::uint32_t number) {
  FrameWriter writer({Direction::up, 1, number});
  board.fill(writer, number);
  const auto frame = decode_frame(std::move(writer).finish(), Direction::up);
  std::vector<CommandReport> reports;
  for (const auto& record : frame->records) reports.push_back(std::get<CommandReport>(record));
  return reports;
}

TEST(ReportBoard, AReportIsSentAgainOnlyWhenLost) {
  ReportBoard board;
  board.post(kAccepted);
  EXPECT_EQ(filled(board, 1), std::vector{kAccepted});
  EXPECT_FALSE(board.has_news());
  board.on_lost(1);
  EXPECT_EQ(filled(board, 2), std::vector{kAccepted});
  board.on_acked(2);
  board.on_session();
  EXPECT_FALSE(board.has_news());
}

TEST(ReportBoard, TheNewestStateReplacesTheOneBefore) {
  ReportBoard board;
  board.post(kAccepted);
  EXPECT_EQ(filled(board, 1).size(), 1U);
  board.post(kArrived);
  EXPECT_EQ(filled(board, 2), std::vector{kArrived});
  board.on_acked(1);
  board.on_lost(2);
  EXPECT_TRUE(board.has_news()) << "the old frame's acknowledgement says nothing of the new state";
}

TEST(ReportBoard, SayingTheSameAgainSendsNothing) {
  ReportBoard board;
  board.post(kAccepted);
  (void)filled(board, 1);
  board.on_acked(1);
  board.post(kAccepted);
  EXPECT_FALSE(board.has_news());
}

TEST(ReportBoard, WhatWasSaidIsSaidAgainWhenAsked) {
  ReportBoard board;
  EXPECT_FALSE(board.ask(1, 0));
  board.post(kArrived);
  (void)filled(board, 1);
  board.on_acked(1);
  EXPECT_TRUE(board.ask(1, 0));
  EXPECT_EQ(filled(board, 2), std::vector{kArrived});
}

TEST(ReportBoard, AtItsBoundAnAcknowledgedReportIsForgottenFirst) {
  ReportBoard board;
  for (std::uint64_t id = 1; id <= ReportBoard::kMaxReports; ++id) {
    board.post({id, 0, CommandState::accepted, ""});
    if (id != 5) continue;
    (void)filled(board, 1);
    board.on_acked(1);
    board.post({1, 0, CommandState::arrived, ""});  // 1 has news again, 2 … 5 have not.
  }
  board.post({99, 0, CommandState::accepted, ""});
  EXPECT_TRUE(board.ask(1, 0));
  EXPECT_FALSE(board.ask(2, 0));
}

}  // namespace
}  // namespace cairn::proto
