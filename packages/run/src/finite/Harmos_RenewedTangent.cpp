// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RenewedTangent.hpp"

namespace Harmos::run {

RenewedTangent::RenewedTangent(const DeformedBodies& bodies, DeformedBodies::Tangent tangent,
                               const feti::TornVector& displacement)
    : bodies_(bodies),
      tangent_(std::move(tangent)),
      displacement_(displacement),
      isMade_(displacement.size(), 0),
      yields_(isMade_),
      times_(displacement.size(), 0.0) {}

void RenewedTangent::make(const feti::TornVector& displacement, double time, const std::vector<char>& which) {
  bodies_.makeTangent(displacement, std::vector<double>(which.size(), time), which, tangent_);
  for (std::size_t i = 0; i < which.size(); ++i)
    if (which[i] != 0) {
      displacement_[i] = displacement[i];
      times_[i] = time;
      isMade_[i] = 1;
      yields_[i] = 0;
    }
}

// Also of those that yielded when theirs was made.
void RenewedTangent::renew(const feti::TornVector& displacement, double time, const std::vector<char>& yields,
                           bool isWrong) {
  std::vector<char> which = yields;
  for (std::size_t i = 0; i < which.size(); ++i)
    which[i] = which[i] != 0 || yields_[i] != 0 || isWrong ? 1 : 0;
  make(displacement, time, which);
  yields_ = yields;
}

void RenewedTangent::begin(const feti::TornVector& displacement, double time) {
  make(displacement, time, std::vector<char>(yields_)); // a restart has no other
}

void RenewedTangent::reset(const feti::TornVector& displacement, double time) {
  make(displacement, time, std::vector<char>(isMade_.size(), 1));
}

void RenewedTangent::noteYielding(const std::vector<char>& yields) {
  for (std::size_t i = 0; i < yields_.size(); ++i)
    yields_[i] = yields_[i] != 0 || yields[i] != 0 ? 1 : 0;
}

std::vector<std::optional<feti::Frame>> RenewedTangent::frames(const feti::TornVector& displacement) const {
  return bodies_.frames(displacement_, displacement);
}

void RenewedTangent::exchange(TornArchive& torn, bool isReading) {
  torn.exchange("displacement of the tangent", displacement_);
  feti::TornVector marks;
  for (std::size_t i = 0; i < isMade_.size(); ++i)
    marks.push_back({static_cast<double>(isMade_[i]), static_cast<double>(yields_[i]), times_[i]});
  torn.exchangeNumbers("tangents made", marks);
  if (!isReading)
    return;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    isMade_[i] = marks[i][0] != 0.0 ? 1 : 0;
    yields_[i] = marks[i][1] != 0.0 ? 1 : 0;
    times_[i] = marks[i][2];
  }
  bodies_.makeTangent(displacement_, times_, isMade_, tangent_);
}

} // namespace Harmos::run
