// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <memory>
#include <string>

namespace Harmos {

/// Where a run's messages go. Injected; libraries never write to std::cout on their own.
///
/// A default Log is silent. Only an active Log writes; applications make it active on rank 0 alone, so that
/// every message appears once. Errors go to a stream of their own and are written at any verbosity.
class Log {
 public:
  enum class Verbosity { Quiet, Normal, Detailed };

  /// Silent.
  Log() = default;

  /// @param out progress and results; @param err errors and warnings. Both must outlive the Log.
  Log(std::ostream& out, std::ostream& err, Verbosity verbosity, bool active);

  void error(const std::string& message) const;
  void warning(const std::string& message) const;
  void info(const std::string& message) const;
  void detail(const std::string& message) const;

  /// The same, but silent where info() and detail() would write; the status line goes on.
  Log withoutInfo() const;

  /// From now on status() shows a line, of at most `width` characters: for a terminal.
  void showStatus(int width);
  bool showsStatus() const { return status_ != nullptr && active_ && verbosity_ != Verbosity::Quiet; }
  /// A line that takes the place of the one before it; other messages come above it. "" takes it away.
  void status(const std::string& line) const;

  /// True where info() would write; lets a caller skip the making of an expensive message.
  bool writesInfo() const { return active_ && !isMuted_ && verbosity_ != Verbosity::Quiet; }

 private:
  struct Status {
    int width;
    bool shown = false;
  };
  void clearStatus() const;

  std::shared_ptr<Status> status_; // of all copies: they share the terminal
  std::ostream* out_ = nullptr;
  std::ostream* err_ = nullptr;
  Verbosity verbosity_ = Verbosity::Quiet;
  bool active_ = false;
  bool isMuted_ = false; // info and detail
};

/// A number for people: three significant digits of scientific notation.
std::string scientific(double value, int digits = 2);

} // namespace Harmos
