#include "proto/sync/report_board.h"

#include <algorithm>

namespace cairn::proto {

void ReportBoard::post(const CommandReport& report) {
  Entry* known = find(report.command, report.revision);
  if (known == nullptr) {
    make_room();
    entries_.push_back({.report = report});
  } else if (known->report != report) {
    *known = {.report = report};
  }
}

bool ReportBoard::ask(std::uint64_t command, std::uint32_t revision) {
  Entry* entry = find(command, revision);
  if (entry != nullptr && entry->transit.acknowledged()) entry->transit.again();
  return entry != nullptr;
}

bool ReportBoard::has_news() const {
  return std::ranges::any_of(entries_, [](const Entry& e) { return e.transit.waits(); });
}

int ReportBoard::fill(FrameWriter& frame, std::uint32_t number) {
  int added = 0;
  for (Entry& entry : entries_) {
    if (!entry.transit.waits() || !frame.add(entry.report)) continue;
    entry.transit.sent(number);
    ++added;
  }
  return added;
}

void ReportBoard::on_acked(std::uint32_t number) {
  for (Entry& entry : entries_) entry.transit.on_acked(number);
}

void ReportBoard::on_lost(std::uint32_t number) {
  for (Entry& entry : entries_) entry.transit.on_lost(number);
}

void ReportBoard::on_session() {
  for (Entry& entry : entries_) {
    if (!entry.transit.acknowledged()) entry.transit.again();
  }
}

ReportBoard::Entry* ReportBoard::find(std::uint64_t command, std::uint32_t revision) {
  const auto found = std::ranges::find_if(entries_, [&](const Entry& e) {
    return e.report.command == command && e.report.revision == revision;
  });
  return found == entries_.end() ? nullptr : &*found;
}

void ReportBoard::make_room() {
  if (entries_.size() < kMaxReports) return;
  const auto said =
      std::ranges::find_if(entries_, [](const Entry& e) { return e.transit.acknowledged(); });
  entries_.erase(said == entries_.end() ? entries_.begin() : said);
}

}  // namespace cairn::proto
