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
    : comm_(comm),
      contact_(contact),
      owned_(owned),
      components_(components),
      values_(contact.locks.size(), 0.0) {}

bool Locks::isLocked(std::size_t lock, double time) const {
  const double from = contact_.locks[lock].from;
  return time > from + rounding * std::abs(from);
}

void Locks::apply(const scene::ContactSetup& contact, std::vector<ConstraintRow>& rows, double time) const {
  if (comm_.getRank() != 0)
    return;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    ConstraintRow& row = rows[contact.locks[k].place];
    row.bound = values_[k];
    row.softness = isLocked(k, time) ? std::optional<double>(0.0) : std::nullopt;
  }
}

// Of the mean of the copies of each dof.
double Locks::valueOf(const scene::ContactSetup::Lock& lock, const feti::TornVector& displacement) const {
  std::unordered_map<long long, std::size_t> places;
  for (const ConstraintRow::Term& term : lock.terms)
    places.emplace(term.dof, places.size());
  std::vector<double> sums(2 * places.size(), 0.0); // of each dof, and how many copies there are
  for (std::size_t i = 0; i < owned_.size(); ++i) {
    const fem::PlacedMesh& placed = owned_[i].mesh;
    for (std::size_t k = 0; k < placed.boundaryNumbers.size(); ++k)
      for (int c = 0; c < components_; ++c)
        if (const auto found = places.find(placed.boundaryNumbers[k] * components_ + c);
            found != places.end()) {
          sums[2 * found->second] +=
              displacement[i][static_cast<std::size_t>(placed.mesh->boundary[k] * components_ + c)];
          sums[2 * found->second + 1] += 1.0;
        }
  }
  globalSum(comm_, sums);
  double value = 0.0;
  for (const ConstraintRow::Term& term : lock.terms) {
    const std::size_t place = places.at(term.dof);
    value += term.coefficient * sums[2 * place] / sums[2 * place + 1];
  }
  return value;
}

std::string Locks::commit(double time, const feti::TornVector& displacement) {
  std::string text;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (isLocked(k, time))
      continue;
    values_[k] = valueOf(contact_.locks[k], displacement);
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
