// SPDX-License-Identifier: BSD-3-Clause

/// The part of Constraints that changes: bounds, limits, softness and statuses.

#include "Harmos_Agreement.hpp"
#include "Harmos_Constraints.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GivenRows.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::feti {
namespace {

using Status = ConstraintRow::Status;

std::vector<std::vector<double>> prescribedOf(const SubdomainSystem& system) {
  std::vector<std::vector<double>> values;
  for (int i = 0; i < system.size(); ++i) {
    values.emplace_back();
    for (const FixedDof& fixed : system.subdomain(i).fixed)
      values.back().push_back(fixed.value);
  }
  return values;
}

bool areZero(const std::vector<std::vector<double>>& values) {
  return std::all_of(values.begin(), values.end(), [](const std::vector<double>& part) {
    return std::all_of(part.begin(), part.end(), [](double value) { return value == 0.0; });
  });
}

// But for what may change.
bool isSameRow(const ConstraintRow& a, const ConstraintRow& b) {
  const auto sameTerm = [](const ConstraintRow::Term& x, const ConstraintRow::Term& y) {
    return x.dof == y.dof && x.coefficient == y.coefficient;
  };
  return a.kind == b.kind && a.number == b.number && a.compliance == b.compliance &&
         a.softness == b.softness && a.limit == b.limit && a.disc == b.disc &&
         a.coefficient == b.coefficient && a.normal == b.normal && a.terms.size() == b.terms.size() &&
         std::equal(a.terms.begin(), a.terms.end(), b.terms.begin(), sameTerm);
}

} // namespace

void Constraints::keepGiven(const std::vector<ConstraintRow>& rows, const std::vector<char>& isTaken,
                            const std::vector<Details::GivenRow>& parts) {
  given_ = rows;
  prescribed_ = prescribedOf(*system_);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const bool isPlain = isTaken[r] == 0 && parts[r].hasUnknown && !parts[r].isIdle &&
                         rows[r].kind == ConstraintRow::Kind::Inequality && !rows[r].softness;
    standing_.push_back(isPlain ? Standing::Plain : isTaken[r] != 0 ? Standing::Taken : Standing::Other);
    subtracted_.push_back(parts[r].prescribed);
  }
}

void Constraints::setBounds(const std::vector<ConstraintRow>& rows) {
  if (setPlainBounds(rows))
    return;
  const Constraints changed(*system_, rows, hasWeights_, weights_);
  agree(*system_->comm(), [&] {
    if (changed.types_ != types_ || changed.entries_ != entries_ || changed.compliances_ != compliances_ ||
        changed.pairs_ != pairs_ || !changed.rowMap_->isLocallyFitted(*rowMap_))
      throw InputError("setBounds() changes bounds only, but the number, kinds, dofs, coefficients or "
                       "compliances of constraint rows differ (with weights, also a nonzero bound of a row "
                       "that glues two dofs); create new constraints");
  });
  takeBounds(changed);
}

// Where bounds and statuses of inequalities with unknowns alone change, nothing has to be found out anew:
// what was taken from their bounds stays, or is zero where all prescribed values are. @return whether that is
// so, on all ranks.
bool Constraints::setPlainBounds(const std::vector<ConstraintRow>& rows) {
  const std::vector<std::vector<double>> prescribed = prescribedOf(*system_);
  bool isPlain = rows.size() == given_.size() && followerCount_ == 0, onlyPlain = true;
  for (std::size_t r = 0; isPlain && r < rows.size(); ++r) {
    const bool isMine = standing_[r] == Standing::Plain;
    const bool stays = rows[r].bound == given_[r].bound && rows[r].status == given_[r].status;
    isPlain = isSameRow(rows[r], given_[r]) && (isMine ? std::isfinite(rows[r].bound) : stays);
    onlyPlain = onlyPlain && (isMine || (standing_[r] == Standing::Taken && rows[r].bound == 0.0));
  }
  std::vector<double> differs = {isPlain && prescribed == prescribed_ ? 0.0 : 1.0,
                                 isPlain && onlyPlain && areZero(prescribed) ? 0.0 : 1.0};
  globalMax(*system_->comm(), differs);
  const bool isSame = differs[0] == 0.0;
  if (!isSame && differs[1] != 0.0)
    return false;
  MultiVector given(givenMap_, 3), owned(rowMap_, 3); // bound, status, whether it is one of these
  {
    const auto view = given.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t k = 0; k < view.extent(0); ++k)
      view(k, 0) = view(k, 1) = view(k, 2) = 0.0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (standing_[r] != Standing::Plain)
        continue;
      double bound = rows[r].bound;
      for (double part : subtracted_[r])
        bound -= isSame ? part : 0.0;
      const MultiplierTerm& term = multipliers_[r].front();
      const auto place = static_cast<std::size_t>(term.place);
      view(place, 0) = term.factor * bound;
      view(place, 1) = static_cast<double>(static_cast<int>(rows[r].status));
      view(place, 2) = 1.0;
    }
  }
  owned.putScalar(0.0);
  owned.doExport(given, *givenImport_, Tpetra::ADD);
  const auto view = owned.getLocalViewHost(Tpetra::Access::ReadOnly);
  std::vector<double> sums(2, 0.0); // open contacts, squares of what bounds are known to
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (standing_[r] != Standing::Taken)
      sums[1] += std::pow(multipliers_[r].front().factor * rows[r].rounding, 2);
  for (std::size_t r = 0; r < view.extent(0); ++r) {
    if (view(r, 2) == 0.0) {
      bounds_[r] = isSame ? bounds_[r] : 0.0;
      continue;
    }
    bounds_[r] = view(r, 0);
    statuses_[r] = static_cast<Status>(static_cast<int>(view(r, 1)));
    isInterval_[r] = statuses_[r] == Status::Open ? 1 : 0;
    sums[0] += isInterval_[r];
  }
  globalSum(*system_->comm(), sums);
  openCount_ = static_cast<long long>(sums[0]);
  boundRounding_ = std::sqrt(sums[1]);
  given_ = rows;
  prescribed_ = prescribed;
  for (std::vector<double>& parts : subtracted_)
    for (double& part : parts)
      part = isSame ? part : 0.0;
  return true;
}

Constraints Constraints::withBounds(const SubdomainSystem& system,
                                    const std::vector<ConstraintRow>& rows) const {
  Constraints other = *this;
  other.system_ = &system;
  other.setBounds(rows);
  return other;
}

void Constraints::takeBounds(const Constraints& changed) {
  bounds_ = changed.bounds_;
  limits_ = changed.limits_;
  softness_ = changed.softness_;
  hasSoft_ = changed.hasSoft_;
  softLimited_ = changed.softLimited_;
  discs_ = changed.discs_;
  discCount_ = changed.discCount_;
  statuses_ = changed.statuses_;
  openCount_ = changed.openCount_;
  isInterval_ = changed.isInterval_;
  followers_ = changed.followers_;
  followerCount_ = changed.followerCount_;
  boundRounding_ = changed.boundRounding_;
  given_ = changed.given_;
  prescribed_ = changed.prescribed_;
  standing_ = changed.standing_;
  subtracted_ = changed.subtracted_;
}

} // namespace Harmos::feti
