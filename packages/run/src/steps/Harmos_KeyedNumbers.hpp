// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::run {

/// Items that ranks own, by keys that no two of them share: sums over all of them, and their numbers as part
/// of a checkpoint, which another number of ranks can read.
class KeyedNumbers {
 public:
  /// @param keys ≥ 0, of this rank's items. @note Collective.
  KeyedNumbers(const Teuchos::Comm<int>& comm, std::vector<long long> keys);

  std::size_t size() const { return places_.size(); }
  /// Of all ranks.
  std::size_t count() const { return count_; }
  /// Sums of the ranks' numbers, the same on all of them. @note Collective.
  void sum(std::vector<double>& values) const;
  double largest(double value) const;

  /// So many numbers for each item of this rank, in their order. @throws InputError on all ranks if the
  /// archive has another count of them. @note Collective; all numbers are on every rank for a moment.
  void exchange(qp::StateArchive<MultiVector>& archive, const std::string& name, const std::string& label,
                std::vector<double>& own) const;

 private:
  const Teuchos::Comm<int>& comm_;
  std::vector<std::size_t> places_; // of the items, in the order of all keys
  std::size_t count_ = 0;
};

} // namespace Harmos::run
