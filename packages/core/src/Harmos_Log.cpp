// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Log.hpp"

#include <iomanip>
#include <ostream>
#include <sstream>

namespace Harmos {

Log::Log(std::ostream& out, std::ostream& err, Verbosity verbosity, bool active)
    : out_(&out), err_(&err), verbosity_(verbosity), active_(active) {}

Log Log::withoutInfo() const {
  Log muted = *this;
  muted.isMuted_ = true;
  return muted;
}

void Log::showStatus(int width) {
  status_ = std::make_shared<Status>(Status{width});
}

void Log::clearStatus() const {
  if (status_ == nullptr || !status_->shown)
    return;
  *out_ << "\r\033[K" << std::flush; // to the beginning of the line, and erase it
  status_->shown = false;
}

void Log::status(const std::string& line) const {
  if (!showsStatus())
    return;
  clearStatus();
  if (line.empty())
    return;
  *out_ << line.substr(0, static_cast<std::size_t>(status_->width)) << std::flush;
  status_->shown = true;
}

void Log::error(const std::string& message) const {
  clearStatus();
  if (active_)
    *err_ << "error: " << message << std::endl;
}

void Log::warning(const std::string& message) const {
  clearStatus();
  if (active_)
    *err_ << "warning: " << message << std::endl;
}

void Log::info(const std::string& message) const {
  if (isMuted_)
    return;
  clearStatus();
  if (writesInfo())
    *out_ << message << std::endl;
}

void Log::detail(const std::string& message) const {
  if (isMuted_)
    return;
  clearStatus();
  if (active_ && verbosity_ == Verbosity::Detailed)
    *out_ << message << std::endl;
}

std::string scientific(double value, int digits) {
  std::ostringstream text;
  text << std::scientific << std::setprecision(digits) << value;
  return text.str();
}

} // namespace Harmos
