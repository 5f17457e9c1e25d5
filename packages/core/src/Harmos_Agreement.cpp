// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Agreement.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <new>
#include <optional>
#include <string>

namespace Harmos {
namespace {

struct Failure {
  Error::Kind kind;
  std::string message;
  ErrorData data;
};

std::optional<Failure> describe(const std::exception_ptr& failure) {
  if (!failure)
    return std::nullopt;
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    return Failure{error.kind(), error.what(), error.data()};
  } catch (const std::bad_alloc&) {
    return Failure{Error::Kind::Internal,
                   "out of memory; use more ranks or nodes, or a coarser mesh",
                   {{"cause", "bad_alloc"}}};
  } catch (const std::exception& error) {
    return Failure{Error::Kind::Internal, std::string("unexpected error: ") + error.what(), {}};
  } catch (...) {
    return Failure{Error::Kind::Internal, "unexpected error of unknown type", {}};
  }
}

void broadcast(const Teuchos::Comm<int>& comm, int root, std::string& text) {
  int size = static_cast<int>(text.size());
  Teuchos::broadcast<int, int>(comm, root, 1, &size);
  text.resize(static_cast<std::size_t>(size));
  if (size > 0)
    Teuchos::broadcast<int, char>(comm, root, size, text.data());
}

// Data travels as one string; control characters that no message contains separate the fields.
std::string pack(const ErrorData& data) {
  std::string text;
  for (const auto& [name, value] : data)
    text += name + '\x1f' + value + '\x1e';
  return text;
}

ErrorData unpack(const std::string& text) {
  ErrorData data;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t middle = text.find('\x1f', begin);
    const std::size_t end = text.find('\x1e', middle);
    data.emplace_back(text.substr(begin, middle - begin), text.substr(middle + 1, end - middle - 1));
    begin = end + 1;
  }
  return data;
}

} // namespace

void agreeOnFailure(const Teuchos::Comm<int>& comm, const std::exception_ptr& failure) {
  const std::optional<Failure> mine = describe(failure);
  const int ranks = comm.getSize();
  // The lowest failing rank by a minimum, the number of failing ranks needs a second reduction, made only
  // after a failure: success costs one.
  const int candidate = mine ? comm.getRank() : ranks;
  int root = ranks;
  Teuchos::reduceAll<int, int>(comm, Teuchos::REDUCE_MIN, 1, &candidate, &root);
  if (root == ranks)
    return;

  const int failed = mine ? 1 : 0;
  int failures = 0;
  Teuchos::reduceAll<int, int>(comm, Teuchos::REDUCE_SUM, 1, &failed, &failures);
  int kind = mine ? static_cast<int>(mine->kind) : 0;
  std::string message = mine ? mine->message : std::string();
  std::string data = mine ? pack(mine->data) : std::string();
  Teuchos::broadcast<int, int>(comm, root, 1, &kind);
  broadcast(comm, root, message);
  broadcast(comm, root, data);
  // Bad input is read and found by rank 0 for all: its number would only puzzle the user.
  const bool isOrdinary = static_cast<Error::Kind>(kind) == Error::Kind::Input && failures == 1 && root == 0;
  if (ranks > 1 && !isOrdinary) {
    message += " [on rank " + std::to_string(root);
    if (failures > 1)
      message += ", and on " + std::to_string(failures - 1) + " more";
    message += "]";
  }
  throwAgreedError(static_cast<Error::Kind>(kind), message, unpack(data));
}

} // namespace Harmos
