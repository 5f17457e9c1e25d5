// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EnergyAccount.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::run {

EnergyAccount::EnergyAccount(std::vector<scene::TimedLoads::Case> cases, bool dissipates, bool breaks)
    : cases_(std::move(cases)), dissipates_(dissipates), breaks_(breaks) {
  const std::vector<double> nothing(cases_.size(), 0.0);
  before_ = {nothing, {nothing, nothing}};
}

void EnergyAccount::reach(Answer answer) {
  stored_ = answer.lagrangian + answer.freeStrainEnergy - answer.frictionWork;
  dissipated_ = committedDissipation_ + answer.frictionWork;
  work_ = committedWork_ + answer.furtherWork + answer.freeStrainEnergy - before_.freeStrainEnergy;
  for (std::size_t c = 0; c < cases_.size(); ++c) {
    const double h0 = before_.factors[c], h1 = answer.factors[c];
    const double load0 = before_.products.load[c], load1 = answer.products.load[c];
    const double motion0 = before_.products.motion[c], motion1 = answer.products.motion[c];
    if (cases_[c].isStrain) {
      work_ -= 0.5 * (load0 + load1) * (h1 - h0);
    } else {
      stored_ += h1 * load1;
      work_ += 0.5 * (h0 + h1) * (load1 - load0);
    }
    work_ += 0.5 * (motion0 + motion1) * (h1 - h0);
  }
  reached_ = std::move(answer);
  const double broken = reached_.breaking - before_.breaking;
  const double left = work_ - committedWork_ - (stored_ - committedStored_) -
                      (dissipated_ - committedDissipation_) - broken - (reached_.flow - before_.flow);
  released_ = committedRelease_ + (broken > 0.0 ? std::max(0.0, left) : 0.0);
}

double EnergyAccount::snapped() const {
  double error = 0.0;
  for (std::size_t c = 0; c < cases_.size(); ++c)
    error += 0.5 * std::abs(reached_.factors[c] - before_.factors[c]) *
             (std::abs(reached_.products.load[c] - before_.products.load[c]) +
              std::abs(reached_.products.motion[c] - before_.products.motion[c]));
  const double released = released_ - committedRelease_;
  return released > error ? released : 0.0;
}

void EnergyAccount::commit() {
  before_ = reached_;
  committedWork_ = work_;
  committedDissipation_ = dissipated_;
  committedStored_ = stored_;
  committedRelease_ = released_;
}

void EnergyAccount::exchange(qp::StateArchive<MultiVector>& archive) {
  archive.numbers("factors", before_.factors);
  archive.numbers("products of loads", before_.products.load);
  archive.numbers("products of motions", before_.products.motion);
  archive.number("free strain energy", before_.freeStrainEnergy);
  archive.number("external work", committedWork_);
  if (dissipates_)
    archive.number("dissipated", committedDissipation_);
  if (!breaks_)
    return;
  archive.number("dissipated by damage", before_.breaking);
  archive.number("dissipated by flow", before_.flow);
  archive.number("stored", committedStored_);
  archive.number("released", committedRelease_);
}

} // namespace Harmos::run
