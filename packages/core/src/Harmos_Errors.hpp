// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace Harmos {

/// Named values that belong to an error: subdomain, residual, parameter path, ...
using ErrorData = std::vector<std::pair<std::string, std::string>>;

/// Base of everything Harmos throws on purpose.
///
/// The message names the cause, the place and the remedy; data() carries the same facts for programs.
/// Guarded by tests/unit/core/test_agreement.cpp.
class Error : public std::runtime_error {
 public:
  /// Who can do something about it; the order is that of the exit status of the applications.
  enum class Kind { Input, Numerical, Internal };

  Error(Kind kind, const std::string& message, ErrorData data = {});

  Kind kind() const { return kind_; }
  const ErrorData& data() const { return data_; }

  /// Whether every rank throws it: set where ranks agree. An internal error that is not agreed on stands
  /// alone; the other ranks may wait for this one, and only an abort helps.
  bool isAgreed() const { return agreed_; }
  void markAgreed() { agreed_ = true; }

 private:
  Kind kind_;
  ErrorData data_;
  bool agreed_ = false;
};

/// The user can mend it: a wrong parameter, a missing file, an inconsistent scene.
class InputError : public Error {
 public:
  explicit InputError(const std::string& message, ErrorData data = {})
      : Error(Kind::Input, message, std::move(data)) {}
};

/// The numbers do not allow the computation; data() says which ones.
class NumericalError : public Error {
 public:
  explicit NumericalError(const std::string& message, ErrorData data = {})
      : Error(Kind::Numerical, message, std::move(data)) {}
};

/// A bug in Harmos, or a resource that gave out.
class InternalError : public Error {
 public:
  explicit InternalError(const std::string& message, ErrorData data = {})
      : Error(Kind::Internal, message, std::move(data)) {}
};

/// Throws an error of the given kind, marked as agreed on.
[[noreturn]] void throwAgreedError(Error::Kind kind, const std::string& message, ErrorData data);

namespace Details {
[[noreturn]] void throwFailedRequirement(const char* condition, const char* file, int line,
                                         const std::string& message);
}

} // namespace Harmos

/// Throws InternalError with file and line when the condition does not hold; always compiled in.
#define HARMOS_REQUIRE(condition, message)                                                                   \
  do {                                                                                                       \
    if (!(condition))                                                                                        \
      ::Harmos::Details::throwFailedRequirement(#condition, __FILE__, __LINE__, (message));                  \
  } while (false)
