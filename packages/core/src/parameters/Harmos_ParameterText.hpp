// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <string>

/// What the parts of ParameterSpec share.

namespace Harmos {

/// The name of the sublists of parameters that few users set.
constexpr const char* expertName = "Expert";

inline std::string quoted(const std::string& text) {
  return "\"" + text + "\"";
}

/// The whole text as a value, or nothing.
template<class T>
bool parseNumber(const std::string& text, T& value) {
  std::istringstream stream(text);
  return static_cast<bool>(stream >> value) && (stream >> std::ws).eof();
}

} // namespace Harmos
