// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Locks.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <unordered_map>

namespace Harmos::run {
namespace {

constexpr double rounding = 1e-12; // of times

} // namespace

Locks::Locks(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
             const std::vector<scene::OwnedSubdomain>& owned, int components)
    : comm_(comm), contact_(contact), values_(contact.locks.size(), 0.0) {
  std::unordered_map<long long, std::vector<Copy>> copies; // of dofs of locks
  for (const scene::ContactSetup::Lock& lock : contact.locks)
    for (const ConstraintRow::Term& term : lock.terms)
      copies[term.dof];
  for (std::size_t i = 0; i < owned.size() && !copies.empty(); ++i) {
    const fem::PlacedMesh& placed = owned[i].mesh;
    for (std::size_t k = 0; k < placed.boundaryNumbers.size(); ++k)
      for (int c = 0; c < components; ++c)
        if (const auto found = copies.find(placed.boundaryNumbers[k] * components + c); found != copies.end())
          found->second.push_back({i, static_cast<std::size_t>(placed.mesh->boundary[k] * components + c)});
  }
  for (const scene::ContactSetup::Lock& lock : contact.locks) {
    terms_.emplace_back();
    for (const ConstraintRow::Term& term : lock.terms)
      terms_.back().push_back({term.coefficient, copies.at(term.dof)});
  }
}

bool Locks::isLocked(std::size_t lock, double time) const {
  const double from = contact_.locks[lock].from;
  return time > from + rounding * std::abs(from);
}

void Locks::apply(std::vector<ConstraintRow>& rows, double time) const {
  if (comm_.getRank() != 0)
    return;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    ConstraintRow& row = rows[contact_.locks[k].place];
    row.bound = values_[k];
    row.softness = isLocked(k, time) ? std::optional<double>(0.0) : std::nullopt;
  }
}

std::string Locks::commit(double time, const feti::TornVector& displacement) {
  std::string text;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (isLocked(k, time))
      continue;
    std::vector<double> sums; // of the copies of each term, and how many there are
    for (const Term& term : terms_[k]) {
      sums.push_back(0.0);
      for (const Copy& copy : term.copies)
        sums.back() += displacement[copy.subdomain][copy.dof];
      sums.push_back(static_cast<double>(term.copies.size()));
    }
    globalSum(comm_, sums);
    values_[k] = 0.0;
    for (std::size_t t = 0; t < terms_[k].size(); ++t)
      values_[k] += terms_[k][t].coefficient * sums[2 * t] / sums[2 * t + 1];
    const double from = contact_.locks[k].from;
    if (std::abs(time - from) <= rounding * std::abs(from))
      text += (text.empty() ? "" : "; ") + contact_.locks[k].effect->label() + " is locked at a shift of " +
              scientific(values_[k], 6);
  }
  return text;
}

void Locks::exchange(qp::StateArchive<MultiVector>& archive) {
  if (any())
    archive.numbers("locked equations", values_);
}

} // namespace Harmos::run
