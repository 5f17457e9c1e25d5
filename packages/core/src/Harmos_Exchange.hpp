// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_Comm.hpp>

#include <cstddef>
#include <type_traits>
#include <vector>

namespace Harmos {

namespace Details {
/// Sends sends[r] to rank r and returns what each rank sent here, as raw bytes.
std::vector<std::vector<char>> exchangeBytes(const Teuchos::Comm<int>& comm,
                                             const std::vector<std::vector<char>>& sends);
} // namespace Details

/// Sends the items of sends[r] to rank r; returns received[r], the items that rank r sent here, in its order.
///
/// For set-up phases (rendezvous of shared dofs): it costs O(ranks) messages' worth of counts. Nothing in an
/// iteration uses it.
///
/// @param sends one vector for each rank of the communicator.
/// @throws InternalError on every rank, if more than 2 GiB would go from one rank in one call.
/// @note Collective.
template<class T>
std::vector<std::vector<T>> exchangeItems(const Teuchos::Comm<int>& comm,
                                          const std::vector<std::vector<T>>& sends) {
  static_assert(std::is_trivially_copyable_v<T>, "items travel as bytes");
  std::vector<std::vector<char>> bytes(sends.size());
  for (std::size_t r = 0; r < sends.size(); ++r) {
    const char* begin = reinterpret_cast<const char*>(sends[r].data());
    bytes[r].assign(begin, begin + sends[r].size() * sizeof(T));
  }
  const std::vector<std::vector<char>> arrived = Details::exchangeBytes(comm, bytes);
  std::vector<std::vector<T>> received(arrived.size());
  for (std::size_t r = 0; r < arrived.size(); ++r) {
    const T* begin = reinterpret_cast<const T*>(arrived[r].data());
    received[r].assign(begin, begin + arrived[r].size() / sizeof(T));
  }
  return received;
}

/// Concatenation, by rank, of every rank's items.
/// @note Collective.
template<class T>
std::vector<T> gatherAll(const Teuchos::Comm<int>& comm, const std::vector<T>& mine) {
  const std::vector<std::vector<T>> received =
      exchangeItems(comm, std::vector<std::vector<T>>(static_cast<std::size_t>(comm.getSize()), mine));
  std::vector<T> all;
  for (const std::vector<T>& part : received)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Sum over the ranks. @note Collective.
long long globalSum(const Teuchos::Comm<int>& comm, long long value);
double globalSum(const Teuchos::Comm<int>& comm, double value);

/// Sums an array in place over the ranks. @note Collective.
void globalSum(const Teuchos::Comm<int>& comm, std::vector<double>& values);

/// Sums an array in place over the ranks and takes the minimum of one more number: a single reduction.
/// @note Collective.
void globalSumAndMin(const Teuchos::Comm<int>& comm, double* values, int count, double& least);

/// Maximum over the ranks. @note Collective.
double globalMax(const Teuchos::Comm<int>& comm, double value);
long long globalMax(const Teuchos::Comm<int>& comm, long long value);

/// Maxima over the ranks of an array, in place: a single reduction. @note Collective.
void globalMax(const Teuchos::Comm<int>& comm, std::vector<double>& values);

/// Minimum over the ranks. @note Collective.
double globalMin(const Teuchos::Comm<int>& comm, double value);
long long globalMin(const Teuchos::Comm<int>& comm, long long value);

/// Sum over the ranks below this one. @note Collective.
long long exclusiveScan(const Teuchos::Comm<int>& comm, long long value);

} // namespace Harmos
