// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LiveView.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Harmos::run {
namespace {

constexpr double interval = 0.25; // seconds between two updates: as often as an eye can follow

// "41 s", "3 min 10 s", "2 h 05 min".
std::string duration(double seconds) {
  std::ostringstream text;
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (seconds < 10.0)
    text << std::fixed << std::setprecision(1) << seconds << " s";
  else if (whole < 120)
    text << whole << " s";
  else if (whole < 7200)
    text << whole / 60 << " min " << whole % 60 << " s";
  else
    text << whole / 3600 << " h " << std::setw(2) << std::setfill('0') << whole % 3600 / 60 << " min";
  return text.str();
}

} // namespace

void RemainingTime::add(const qp::IterationRecord& record, const feti::DualTargets& targets) {
  double ratio = targets.gradient > 0.0 ? record.projectedGradient / targets.gradient : 0.0;
  if (targets.equality > 0.0)
    ratio = std::max(ratio, record.equalityResidual / targets.equality);
  if (!(ratio > 0.0) || !std::isfinite(ratio))
    return;
  points_.push_back({static_cast<double>(record.inner), record.seconds, std::log(ratio)});
  if (points_.size() > window)
    points_.pop_front();
}

std::optional<double> RemainingTime::seconds() const {
  constexpr std::size_t fewest = 5;
  if (points_.size() < fewest)
    return std::nullopt;
  const auto n = static_cast<double>(points_.size());
  double inner = 0.0, logarithm = 0.0;
  for (const Point& point : points_) {
    inner += point.inner / n;
    logarithm += point.logarithm / n;
  }
  double product = 0.0, square = 0.0;
  for (const Point& point : points_) {
    product += (point.inner - inner) * (point.logarithm - logarithm);
    square += (point.inner - inner) * (point.inner - inner);
  }
  const Point& first = points_.front();
  const Point& last = points_.back();
  if (!(square > 0.0) || !(product < 0.0) || !(last.inner > first.inner))
    return std::nullopt;
  const double slope = product / square;
  const double present = logarithm + slope * (last.inner - inner);
  return std::max(0.0, -present / slope) * (last.seconds - first.seconds) / (last.inner - first.inner);
}

std::string statusLine(const std::string& method, const qp::IterationRecord& record,
                       const feti::DualTargets& targets, const std::optional<double>& remaining) {
  std::ostringstream text;
  // In the order of what may be cut off where a terminal has 80 columns.
  text << method << ' ' << record.outer << '/' << record.inner << "  " << duration(record.seconds);
  if (remaining)
    text << ", " << duration(*remaining) << " left";
  text << "  |g^P| " << scientific(record.projectedGradient, 1) << '/' << scientific(targets.gradient, 1);
  if (targets.equality > 0.0)
    text << "  |G l| " << scientific(record.equalityResidual, 1) << '/' << scientific(targets.equality, 1);
  return text.str();
}

LiveView::LiveView(const std::string& path, const std::string& method, const Log& log,
                   const qp::IterationRecord& before, bool appends)
    : log_(log), method_(method), before_(before) {
  if (path.empty())
    return;
  history_.open(path, appends ? std::ios::app : std::ios::trunc);
  if (!appends)
    qp::writeHistoryHeader(history_);
  history_.flush();
}

LiveView::~LiveView() {
  log_.status("");
}

void LiveView::begin(const std::vector<qp::IterationRecord>& rows) {
  if (!history_.is_open())
    return;
  for (const qp::IterationRecord& row : rows)
    qp::writeHistoryRow(history_, qp::countedOn(row, before_));
  history_.flush();
}

void LiveView::add(const qp::IterationRecord& record, const feti::DualTargets& targets) {
  remaining_.add(record, targets);
  if (history_.is_open())
    qp::writeHistoryRow(history_, qp::countedOn(record, before_));
  const auto now = std::chrono::steady_clock::now();
  if (std::chrono::duration<double>(now - last_).count() < interval)
    return;
  last_ = now;
  if (history_.is_open())
    history_.flush();
  if (log_.showsStatus())
    log_.status(statusLine(method_, record, targets, remaining_.seconds()));
}

} // namespace Harmos::run
