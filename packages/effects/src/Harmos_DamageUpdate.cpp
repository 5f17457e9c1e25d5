// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DamageUpdate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Harmos::effects {
namespace {

// Of what the numbers consist: of each point the damage, that when the step began, what was dissipated, that
// when the step began, the last share of mode II, three stiffnesses of its springs where it softens, and
// three stretches of the answer through which these go. Then of the step: answers, the least that was wrong
// and the answer in which it was, θ, the share that has broken, how often softening springs have met the law,
// and how often nothing got better.
constexpr std::size_t damages = 0, begun = 1, lost = 2, lostBefore = 3, modes = 4, stiffnesses = 5,
                      places = 8;
constexpr std::size_t parts = places + 3;
constexpr std::size_t answers = 0, least = 1, leastAt = 2, damping = 3, broken = 4, agreed = 5, stuck = 6,
                      ofStep = 7;

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

void DamageUpdate::beginStep() {
  std::copy_n(part(damages), points_, part(begun));
  std::copy_n(part(lost), points_, part(lostBefore));
  std::fill_n(part(stiffnesses), 3 * points_, 0.0);
  std::fill_n(part(parts), ofStep, 0.0);
}

bool DamageUpdate::update(const std::vector<Point>& points, double tolerance) {
  for (std::size_t k = 0; k < points_; ++k) // of a point that breaks, as it was then
    if (const CohesiveLaw::Opening opening = openingOf(points[k].stretch);
        part(damages)[k] < 1.0 && opening.size > 0.0)
      part(modes)[k] = opening.share;
  const bool again = law_.isBrittle() ? breakWorst(points, tolerance) : approach(points, tolerance);
  account(points);
  return again;
}

bool DamageUpdate::breakWorst(const std::vector<Point>& points, double tolerance) {
  constexpr double nearly = 0.9;
  const auto strain = [&](std::size_t k) {
    const CohesiveLaw::Opening opening = openingOf(points[k].stretch);
    return part(damages)[k] < 1.0 ? opening.size / law_.onset(opening.share) : 0.0;
  };
  double worst = 0.0;
  for (std::size_t k = 0; k < points_; ++k)
    worst = std::max(worst, strain(k));
  if (!(worst > 1.0 + tolerance))
    return false;
  for (std::size_t k = 0; k < points_; ++k)
    if (const double here = strain(k); here > 1.0 && here >= nearly * worst)
      part(damages)[k] = 1.0;
  return true;
}

// How far the traction of the answer is from what the law says of its opening, as a share of the strength.
double DamageUpdate::wrongness(std::size_t k, const Point& point, double damage) const {
  const Spring its = part(damages)[k] < 1.0 ? spring(numbers_, k) : Spring{};
  double sum = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    double traction = its.stiffness[d] * (point.stretch[d] - its.unstretched[d]);
    if (d == 0)
      traction = std::max(traction, 0.0); // closed ones press
    sum += std::pow(traction - (1.0 - damage) * point.stretch[d], 2);
  }
  return std::sqrt(sum) / law_.onset(openingOf(point.stretch).share);
}

bool DamageUpdate::isThroughOrigin() const {
  return std::all_of(part(stiffnesses), part(stiffnesses) + points_, [](double s) { return s == 0.0; });
}

bool DamageUpdate::approach(const std::vector<Point>& points, double tolerance) {
  std::vector<double> next(points_);
  double worst = 0.0;
  for (std::size_t k = 0; k < points_; ++k) {
    next[k] = std::max(part(begun)[k], law_.damage(openingOf(points[k].stretch)));
    worst = std::max(worst, wrongness(k, points[k], next[k]));
  }
  // Springs through the origin have the same answer as those that met the law, but for what the solver
  // leaves: where it has met the law twice no more is to be had, up to a hundredth of the strength.
  constexpr double certain = 2.0, amplified = 100.0, most = 0.01;
  const bool isThere = worst <= tolerance;
  const bool isAsGood = part(parts)[agreed] >= certain && worst <= std::min(amplified * tolerance, most);
  if (isThroughOrigin() && (isThere || isAsGood))
    return false;
  if (isThere)
    ++part(parts)[agreed];
  const bool opens = snaps(worst) && !isThere;
  for (std::size_t k = 0; k < points_; ++k) {
    Point point = points[k];
    if (opens)
      open(k, point, next[k]);
    part(damages)[k] = next[k];
    part(stiffnesses)[k] = 0.0;
    if (!isThere)
      linearise(k, point);
  }
  return true;
}

// Where nothing gets better the interface snaps, as a rule; else, much later, the way from below comes
// nearer.
// @return whether points beyond the law are to open.
bool DamageUpdate::snaps(double worst) {
  constexpr double first = 0.25, factor = 4.0, patience = 8.0, better = 0.5, mostSnaps = 8.0;
  double* step = part(parts);
  if (++step[answers] == 1.0)
    step[damping] = first;
  if (step[answers] == 1.0 || worst < better * step[least]) {
    step[least] = worst;
    step[leastAt] = step[answers];
  }
  if (step[answers] - step[leastAt] < patience)
    return false;
  step[leastAt] = step[answers];
  if (++step[stuck] <= mostSnaps)
    return true;
  step[damping] *= factor;
  return false;
}

// What pulls more than the law lets it opens to twice as much.
void DamageUpdate::open(std::size_t k, Point& point, double& damage) const {
  if (part(damages)[k] == 1.0 || damage <= part(begun)[k] || damage == 1.0)
    return;
  const Spring its = spring(numbers_, k);
  double beyond = 0.0;
  for (std::size_t d = 0; d < 3; ++d)
    beyond +=
        (its.stiffness[d] * (point.stretch[d] - its.unstretched[d]) - (1.0 - damage) * point.stretch[d]) *
        point.stretch[d];
  if (!(beyond > 0.0))
    return;
  for (double& stretch : point.stretch)
    stretch *= 2.0;
  damage = std::max(damage, law_.damage(openingOf(point.stretch)));
}

void DamageUpdate::linearise(std::size_t k, const Point& point) {
  const double now = part(damages)[k];
  if (now <= part(begun)[k] || now == 1.0)
    return;
  const CohesiveLaw::Opening opening = openingOf(point.stretch);
  const double first = law_.onset(opening.share), last = law_.end(opening.share);
  const double softening = part(parts)[damping] * first / (last - first);
  if (softening >= 1.0 - now)
    return;
  // Across the way in which it opens a traction turns with it: (1 − d)k.
  for (std::size_t d = 0; d < 3; ++d) {
    const double along2 = std::pow(point.stretch[d] / opening.size, 2);
    part(stiffnesses + d)[k] = along2 * softening + (1.0 - along2) * (1.0 - now);
    part(places + d)[k] = point.stretch[d];
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
