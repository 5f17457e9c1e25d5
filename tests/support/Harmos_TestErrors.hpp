// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Errors.hpp"

#include <string>

namespace Harmos {

/// What a call says when it throws an InputError; "" if it does not throw.
template<class Call>
std::string inputErrorOf(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// The same of a NumericalError.
template<class Call>
std::string numericalErrorOf(Call&& call) {
  try {
    call();
  } catch (const NumericalError& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace Harmos
