// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"

namespace Harmos {

Error::Error(Kind kind, const std::string& message, ErrorData data)
    : std::runtime_error(message), kind_(kind), data_(std::move(data)) {}

namespace {

template<class ErrorType>
[[noreturn]] void throwMarked(const std::string& message, ErrorData data) {
  ErrorType error(message, std::move(data));
  error.markAgreed();
  throw error;
}

} // namespace

void throwAgreedError(Error::Kind kind, const std::string& message, ErrorData data) {
  switch (kind) {
  case Error::Kind::Input:
    throwMarked<InputError>(message, std::move(data));
  case Error::Kind::Numerical:
    throwMarked<NumericalError>(message, std::move(data));
  case Error::Kind::Internal:
    break;
  }
  throwMarked<InternalError>(message, std::move(data));
}

namespace Details {

void throwFailedRequirement(const char* condition, const char* file, int line, const std::string& message) {
  const std::string path(file);
  const std::string name = path.substr(path.find_last_of('/') + 1);
  throw InternalError(message + " (" + name + ":" + std::to_string(line) + ", required: " + condition + ")",
                      {{"file", name}, {"line", std::to_string(line)}});
}

} // namespace Details
} // namespace Harmos
