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
  if (entry != nullptr && entry->where == Where::acknowledged) entry->where = Where::waiting;
  return entry != nullptr;
}

bool ReportBoard::has_news() const {
  return std::ranges::any_of(entries_, [](const Entry& e) { return e.where == Where::waiting; });
}

int ReportBoard::fill(FrameWriter& frame, std::uint32_t number) {
  int added = 0;
  for (Entry& entry : entries_) {
    if (entry.where != Where::waiting || !frame.add(entry.report)) continue;
    entry.where = Where::under_way;
    entry.carrier = number;
    ++added;
  }
  return added;
}

void ReportBoard::on_acked(std::uint32_t number) {
  for (Entry& entry : entries_) {
    const bool in_it = entry.where == Where::under_way && entry.carrier == number;
    if (in_it) entry.where = Where::acknowledged;
  }
}

void ReportBoard::on_lost(std::uint32_t number) {
  for (Entry& entry : entries_) {
    const bool in_it = entry.where == Where::under_way && entry.carrier == number;
    if (in_it) entry.where = Where::waiting;
  }
}

void ReportBoard::on_session() {
  for (Entry& entry : entries_) {
    if (entry.where == Where::under_way) entry.where = Where::waiting;
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
  const auto said = std::ranges::find(entries_, Where::acknowledged, &Entry::where);
  entries_.erase(said == entries_.end() ? entries_.begin() : said);
}

}  // namespace cairn::proto
