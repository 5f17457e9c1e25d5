// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Log.hpp"

#include <iomanip>
#include <ostream>
#include <sstream>

namespace Harmos {

Log::Log(std::ostream& out, std::ostream& err, Verbosity verbosity, bool active)
    : out_(&out), err_(&err), verbosity_(verbosity), active_(active) {}

void Log::error(const std::string& message) const {
  if (active_)
    *err_ << "error: " << message << std::endl;
}

void Log::warning(const std::string& message) const {
  if (active_)
    *err_ << "warning: " << message << std::endl;
}

void Log::info(const std::string& message) const {
  if (writesInfo())
    *out_ << message << std::endl;
}

void Log::detail(const std::string& message) const {
  if (active_ && verbosity_ == Verbosity::Detailed)
    *out_ << message << std::endl;
}

std::string scientific(double value, int digits) {
  std::ostringstream text;
  text << std::scientific << std::setprecision(digits) << value;
  return text.str();
}

} // namespace Harmos
