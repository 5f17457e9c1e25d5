// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DamageUpdate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Harmos::effects {
namespace {

// Of what the numbers consist: of each point the damage, that when the step began, what was dissipated, that
// when the step began, the last share of mode II, three stretches of the answer through which its springs go,
// and three stiffnesses of them where it softens. Then the share that has broken in the step.
constexpr std::size_t damages = 0, begun = 1, lost = 2, lostBefore = 3, modes = 4, places = 5,
                      stiffnesses = 8, parts = stiffnesses + 3;
constexpr std::size_t broken = 0, ofStep = 1;

CohesiveLaw::Opening openingOf(const DamageUpdate::Stretch& q) {
  CohesiveLaw::Opening opening;
  const double slip2 = q[1] * q[1] + q[2] * q[2], all2 = q[0] * q[0] + slip2;
  opening.size = std::sqrt(all2);
  opening.share = all2 > 0.0 ? slip2 / all2 : 0.0;
  return opening;
}

} // namespace

std::size_t DamageUpdate::size(std::size_t points) {
  return parts * points + ofStep;
}

DamageUpdate::DamageUpdate(const CohesiveLaw& law, std::vector<double>& numbers)
    : law_(law), numbers_(numbers), points_(points(numbers)) {}

std::size_t DamageUpdate::points(const std::vector<double>& numbers) {
  return (numbers.size() - ofStep) / parts;
}

const double* DamageUpdate::damage(const std::vector<double>& numbers) {
  return numbers.data();
}

double DamageUpdate::dissipated(const std::vector<double>& numbers) {
  const auto n = static_cast<std::ptrdiff_t>(points(numbers));
  const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(lost) * n;
  return std::accumulate(begin, begin + n, 0.0);
}

double DamageUpdate::brokenShare(const std::vector<double>& numbers) {
  return numbers[parts * points(numbers) + broken];
}

DamageUpdate::Spring DamageUpdate::spring(const std::vector<double>& numbers, std::size_t point) {
  const std::size_t n = points(numbers);
  const double left = 1.0 - numbers[damages * n + point];
  Spring spring = {{left, left, left}, {}};
  if (numbers[stiffnesses * n + point] == 0.0 || left == 0.0)
    return spring;
  for (std::size_t d = 0; d < 3; ++d) {
    spring.stiffness[d] = numbers[(stiffnesses + d) * n + point];
    spring.unstretched[d] = numbers[(places + d) * n + point] * (1.0 - left / spring.stiffness[d]);
  }
  return spring;
}

std::optional<DamageUpdate::Stretch> DamageUpdate::brokenAt(const std::vector<double>& numbers,
                                                            std::size_t point) {
  const std::size_t n = points(numbers);
  if (numbers[begun * n + point] == 1.0 || numbers[damages * n + point] < 1.0)
    return std::nullopt;
  Stretch at;
  for (std::size_t d = 0; d < 3; ++d)
    at[d] = numbers[(places + d) * n + point];
  return at;
}

void DamageUpdate::beginStep() {
  std::fill_n(part(stiffnesses), 3 * points_, 0.0);
  std::copy_n(part(damages), points_, part(begun));
  std::copy_n(part(lost), points_, part(lostBefore));
  std::fill_n(part(parts), ofStep, 0.0);
}

void DamageUpdate::keepModes(const std::vector<Point>& points) {
  for (std::size_t k = 0; k < points_; ++k) // of a point that breaks, as it was then
    if (const CohesiveLaw::Opening opening = openingOf(points[k].stretch);
        part(damages)[k] < 1.0 && opening.size > 0.0)
      part(modes)[k] = opening.share;
}

bool DamageUpdate::breakWorst(const std::vector<Point>& points, double tolerance) {
  constexpr double nearly = 0.9;
  keepModes(points);
  const auto strain = [&](std::size_t k) {
    const CohesiveLaw::Opening opening = openingOf(points[k].stretch);
    return part(damages)[k] < 1.0 ? opening.size / law_.onset(opening.share) : 0.0;
  };
  double worst = 0.0;
  for (std::size_t k = 0; k < points_; ++k)
    worst = std::max(worst, strain(k));
  const bool breaks = worst > 1.0 + tolerance;
  for (std::size_t k = 0; k < points_ && breaks; ++k)
    if (const double here = strain(k); here > 1.0 && here >= nearly * worst)
      part(damages)[k] = 1.0;
  account(points);
  return breaks;
}

namespace {

double damageAt(const CohesiveLaw& law, double before, const CohesiveLaw::Opening& opening) {
  return std::max(before, law.damage(opening));
}

} // namespace

DamageUpdate::Stretch DamageUpdate::traction(const CohesiveLaw& law, const std::vector<double>& numbers,
                                             std::size_t point, const Stretch& stretch) {
  const double left = 1.0 - damageAt(law, numbers[begun * points(numbers) + point], openingOf(stretch));
  return {left * stretch[0], left * stretch[1], left * stretch[2]};
}

double DamageUpdate::misfit(const CohesiveLaw& law, const std::vector<double>& numbers,
                            const std::vector<Point>& answer) {
  double worst = 0.0;
  for (std::size_t k = 0; k < answer.size(); ++k) {
    const Stretch& stretch = answer[k].stretch;
    const Spring its = damage(numbers)[k] < 1.0 ? spring(numbers, k) : Spring{};
    const Stretch byLaw = traction(law, numbers, k, stretch);
    double sum = 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
      double found = its.stiffness[d] * (stretch[d] - its.unstretched[d]);
      if (d == 0)
        found = std::max(found, 0.0); // closed ones press
      sum += std::pow(found - byLaw[d], 2);
    }
    worst = std::max(worst, std::sqrt(sum) / law.onset(openingOf(stretch).share));
    // However little it still bears.
    if (damage(numbers)[k] < 1.0 && law.damage(openingOf(stretch)) == 1.0)
      worst = std::max(worst, 1.0);
  }
  return worst;
}

void DamageUpdate::place(std::size_t k, const Stretch& stretch, double share) {
  for (std::size_t d = 0; d < 3; ++d)
    part(places + d)[k] = share * stretch[d];
}

bool DamageUpdate::staysBroken(std::size_t k, const Stretch& stretch, double known) const {
  const CohesiveLaw::Opening opening = openingOf(stretch);
  return part(damages)[k] == 1.0 && part(begun)[k] < 1.0 &&
         (1.0 - law_.damage(opening)) * opening.size <= known * law_.onset(opening.share);
}

bool DamageUpdate::follow(const std::vector<Point>& points, std::optional<double> steepness, double known) {
  bool softens = false;
  keepModes(points);
  for (std::size_t k = 0; k < points_; ++k) {
    const Stretch& stretch = points[k].stretch;
    for (std::size_t d = 0; d < 3; ++d)
      part(stiffnesses + d)[k] = 0.0;
    if (staysBroken(k, stretch, known)) {
      softens = true;
      continue;
    }
    const CohesiveLaw::Opening opening = openingOf(stretch);
    part(damages)[k] = damageAt(law_, part(begun)[k], opening);
    // Of one that breaks: straight on it was there when it did.
    const double share = part(damages)[k] == 1.0 && part(begun)[k] < 1.0
                             ? std::min(1.0, law_.end(opening.share) / opening.size)
                             : 1.0;
    place(k, stretch, share);
    const bool doesIt = part(damages)[k] > part(begun)[k];
    softens = softens || doesIt;
    if (steepness && doesIt && part(damages)[k] < 1.0)
      linearise(k, *steepness);
  }
  account(points);
  return softens;
}

// Through where it is.
void DamageUpdate::linearise(std::size_t k, double steepness) {
  const double left = 1.0 - part(damages)[k];
  const Stretch at = {part(places)[k], part(places + 1)[k], part(places + 2)[k]};
  const CohesiveLaw::Opening opening = openingOf(at);
  const double first = law_.onset(opening.share), last = law_.end(opening.share);
  const double softening = steepness * first / (last - first);
  if (softening >= left)
    return;
  // Across the way in which it opens a traction turns with it: (1 − d)k.
  for (std::size_t d = 0; d < 3; ++d) {
    const double along2 = std::pow(at[d] / opening.size, 2);
    part(stiffnesses + d)[k] = along2 * softening + (1.0 - along2) * left;
  }
}

// What the law dissipates on the way from the beginning of the step.
void DamageUpdate::account(const std::vector<Point>& points) {
  double share = 0.0, whole = 0.0;
  for (std::size_t k = 0; k < points_; ++k) {
    whole += points[k].area;
    const double before = part(begun)[k], now = part(damages)[k];
    const double mode = part(modes)[k];
    part(lost)[k] = part(lostBefore)[k];
    if (now == before)
      continue;
    part(lost)[k] += points[k].area * (law_.dissipated(now, mode) - law_.dissipated(before, mode));
    share += (part(lost)[k] - part(lostBefore)[k]) / law_.fractureEnergy(mode);
  }
  part(parts)[broken] = whole > 0.0 ? share / whole : 0.0;
}

} // namespace Harmos::effects
