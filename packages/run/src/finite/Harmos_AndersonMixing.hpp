// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SubdomainSystem.hpp"

#include <Teuchos_Comm.hpp>

#include <deque>
#include <vector>

namespace Harmos::run {

/// Anderson's acceleration of u ← G(u) (Walker, Ni: Anderson acceleration for fixed-point iterations, SIAM J.
/// Numer. Anal. 49, 2011): the next u is that combination Σα_j G(u_j), Σα_j = 1, of the last ones whose
/// changes Σα_j (G(u_j) − u_j) are the least, in a weighted norm. What is linear in u, and holds for all
/// G(u_j), holds for it.
///
/// Guarded by tests/unit/run/test_finite_displacements.cpp.
class AndersonMixing {
 public:
  static constexpr std::size_t memory = 6;

  /// @param weights of the norm, positive, of this rank's entries; to outlive it, as the communicator.
  AndersonMixing(const Teuchos::Comm<int>& comm, const feti::TornVector& weights)
      : comm_(comm), weights_(weights) {}

  /// Forgets all.
  void restart() { entries_.clear(); }
  /// @param answer G(u) of the last u, @param change G(u) − u. @return the next u. @note Collective.
  feti::TornVector next(const feti::TornVector& answer, const feti::TornVector& change);

  /// For checkpoints: visits all vectors that are kept, of which there are so many once it reads.
  template<class Visit>
  void visit(std::size_t entries, const Visit& visit) {
    entries_.resize(entries);
    for (Entry& entry : entries_) {
      visit(entry.answer);
      visit(entry.change);
    }
  }
  std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    feti::TornVector answer, change;
  };
  double product(const feti::TornVector& a, const feti::TornVector& b) const;

  const Teuchos::Comm<int>& comm_;
  const feti::TornVector& weights_;
  std::deque<Entry> entries_; // the last one at the end
};

} // namespace Harmos::run
