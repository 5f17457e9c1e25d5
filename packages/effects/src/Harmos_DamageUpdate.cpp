// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DamageUpdate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace Harmos::effects {
namespace {

// Of what the numbers consist: of each point the damage, that when the step began, what was dissipated, that
// when the step began, the last share of mode II, of the last answers opening and traction; then the number
// of these, and of the step that of its answers, the share that has broken, how much
// further than the law it has gone on, the least that was beside the law, and in which answer.
constexpr std::size_t damages = 0, begun = 1, lost = 2, lostBefore = 3, modes = 4, memory = 5;
constexpr std::size_t depth = 12; // differences: of a zone of softening, some more than it has points
constexpr std::size_t parts = memory + 2 * (depth + 1);
constexpr std::size_t kept = 0, answers = 1, broken = 2, boost = 3, least = 4, leastAt = 5, ofStep = 6;
constexpr double forget = 30.0, patience = 6.0; // answers
constexpr double mostBoost = 1024.0;

// As if it were a solve of depth equations: symmetric, positive semidefinite, and small pivots are left out.
std::vector<double> leastSquares(std::vector<std::vector<double>> gram, std::vector<double> right) {
  const std::size_t n = right.size();
  std::vector<double> first(n);
  for (std::size_t i = 0; i < n; ++i)
    first[i] = gram[i][i];
  constexpr double small = 1e-12; // squares of differences that are a millionth of others are rounding errors
  std::vector<char> isOut(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!(gram[i][i] > small * first[i])) {
      isOut[i] = 1;
      continue;
    }
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = gram[k][i] / gram[i][i];
      for (std::size_t j = i; j < n; ++j)
        gram[k][j] -= factor * gram[i][j];
      right[k] -= factor * right[i];
    }
  }
  std::vector<double> x(n, 0.0);
  for (std::size_t i = n; i-- > 0;) {
    if (isOut[i] != 0)
      continue;
    double sum = right[i];
    for (std::size_t j = i + 1; j < n; ++j)
      sum -= gram[i][j] * x[j];
    x[i] = sum / gram[i][i];
  }
  return x;
}

} // namespace

double* DamageUpdate::sizeOf(std::size_t answer) {
  return part(memory + 2 * answer);
}

double* DamageUpdate::pullOf(std::size_t answer) {
  return part(memory + 2 * answer + 1);
}

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

void DamageUpdate::beginStep() {
  std::copy_n(part(damages), points_, part(begun));
  std::copy_n(part(lost), points_, part(lostBefore));
  std::fill_n(part(parts) + answers, ofStep - answers, 0.0);
}

bool DamageUpdate::update(const std::vector<Point>& points, double tolerance) {
  for (std::size_t k = 0; k < points_; ++k) // of a point that breaks, as it was then
    if (part(damages)[k] < 1.0 && points[k].opening.size > 0.0)
      part(modes)[k] = points[k].opening.share;
  const bool again = law_.isBrittle() ? breakWorst(points, tolerance) : approach(points, tolerance);
  account(points);
  return again;
}

bool DamageUpdate::breakWorst(const std::vector<Point>& points, double tolerance) {
  constexpr double nearly = 0.9;
  const auto strain = [&](std::size_t k) {
    const CohesiveLaw::Opening& opening = points[k].opening;
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

// Of a point that has come to an opening: what is left of the traction, by the root of the stiffness.
double DamageUpdate::pull(std::size_t k, const CohesiveLaw::Opening& opening) const {
  const double damage = std::max(numbers_[begun * points_ + k], law_.damage(opening));
  return (1.0 - damage) * opening.size;
}

bool DamageUpdate::approach(const std::vector<Point>& points, double tolerance) {
  remember(points);
  double worst = 0.0;
  bool breaks = false; // what little it still carries
  for (std::size_t k = 0; k < points_; ++k) {
    const CohesiveLaw::Opening& opening = points[k].opening;
    breaks = breaks || (part(damages)[k] < 1.0 && law_.damage(opening) == 1.0);
    worst = std::max(worst, std::abs((1.0 - part(damages)[k]) * opening.size - pull(k, opening)) /
                                law_.onset(opening.share));
  }
  if (!(worst > tolerance) && !breaks)
    return false;
  double* step = part(parts);
  if (step[answers] == 1.0 || worst < 0.5 * step[least] || step[answers] - step[leastAt] >= 2.0 * patience) {
    step[least] = worst;
    step[leastAt] = step[answers];
  }
  double& more = step[boost];
  std::vector<double> sizes;
  if (step[answers] - step[leastAt] < patience) // else bodies and law may agree nowhere near
    sizes = combined(points, tolerance);
  more = sizes.empty() ? std::min(2.0 * std::max(0.5, more), mostBoost) : 0.0;
  for (std::size_t k = 0; k < points_; ++k) {
    const CohesiveLaw::Opening& opening = points[k].opening;
    const double last = law_.end(opening.share), now = part(damages)[k];
    if (opening.size >= last) {
      part(damages)[k] = 1.0;
      continue;
    }
    const double most = law_.damage({0.5 * (opening.size + last), opening.share});
    double next = now;
    if (!sizes.empty())
      next = law_.damage({std::max(0.0, sizes[k]), opening.share});
    else if (now < 1.0 && opening.size > 0.0) // by the law alone, and further where that is too slow
      next = 1.0 - (1.0 - now) * std::pow(pull(k, opening) / ((1.0 - now) * opening.size), more);
    else
      next = law_.damage(opening);
    part(damages)[k] = std::clamp(next, part(begun)[k], std::max(part(begun)[k], most));
  }
  return true;
}

// An answer; of a step's first one those before tell what it would have been with their damage, for that is
// the same as in the last answer.
void DamageUpdate::remember(const std::vector<Point>& points) {
  double* step = part(parts);
  auto count = static_cast<std::size_t>(step[kept]);
  // They may be of no use any more: where contacts opened or closed, others slipped.
  if (std::fmod(++step[answers], forget) == 0.0)
    count = 0;
  if (step[answers] == 1.0 && count > 0) {
    --count;
    for (std::size_t k = 0; k < points_; ++k) {
      const double bySize = points[k].opening.size - sizeOf(count)[k];
      for (std::size_t i = 0; i < count; ++i) {
        sizeOf(i)[k] += bySize;
        pullOf(i)[k] += (1.0 - part(damages)[k]) * bySize;
      }
    }
  }
  if (count > depth) { // the oldest goes
    std::copy(sizeOf(1), sizeOf(depth + 1), sizeOf(0));
    count = depth;
  }
  for (std::size_t k = 0; k < points_; ++k) {
    sizeOf(count)[k] = points[k].opening.size;
    pullOf(count)[k] = (1.0 - part(damages)[k]) * points[k].opening.size;
  }
  step[kept] = static_cast<double>(count + 1);
}

// The openings, if they are of use, among those that the last answers span, bodies in balance with tractions,
// at which these are least beside the law, by the method of Gauss and Newton.
std::vector<double> DamageUpdate::combined(const std::vector<Point>& points, double tolerance) {
  const std::size_t last = static_cast<std::size_t>(part(parts)[kept]) - 1;
  std::vector<double> factors(last, 0.0), sizes;
  double noise = 0.0;
  for (const Point& point : points)
    noise += tolerance * tolerance * point.area;
  const double before = residualAt(points, factors, sizes, nullptr);
  double residual = before;
  constexpr int mostSteps = 30, mostHalvings = 10;
  constexpr double enough = 0.999; // of the residual before
  for (int step = 0; step < mostSteps && last > 0; ++step) {
    Normal normal;
    residualAt(points, factors, sizes, &normal);
    for (std::size_t j = 0; j < last; ++j) { // with so much in them that is error
      normal.gram[j][j] += noise;
      normal.right[j] -= noise * factors[j];
    }
    const std::vector<double> change = leastSquares(normal.gram, normal.right);
    double length = 1.0, next = residual;
    std::vector<double> tried = factors;
    for (int half = 0; half < mostHalvings; ++half, length *= 0.5) {
      for (std::size_t j = 0; j < last; ++j)
        tried[j] = factors[j] - length * change[j];
      next = residualAt(points, tried, sizes, nullptr);
      if (next < residual)
        break;
    }
    const bool isBetter = next < enough * residual;
    if (next < residual) {
      factors = tried;
      residual = next;
    }
    if (!isBetter)
      break;
  }
  // What they do not make much better is left to the law.
  constexpr double worthIt = 0.5; // squared
  if (!(residual < worthIt * before))
    return {};
  residualAt(points, factors, sizes, nullptr);
  return sizes;
}

// Of openings e − Σ factor · (e − e_j), e the last ones, and tractions likewise: Σ of the squares of what is
// beside the law, by area and strength; with its derivatives, JᵀJ and Jᵀ of it.
double DamageUpdate::residualAt(const std::vector<Point>& points, const std::vector<double>& factors,
                                std::vector<double>& sizes, Normal* normal) {
  const std::size_t last = factors.size();
  sizes.assign(points_, 0.0);
  if (normal != nullptr)
    *normal = {std::vector<std::vector<double>>(last, std::vector<double>(last, 0.0)),
               std::vector<double>(last, 0.0)};
  std::vector<double> slope(last);
  double sum = 0.0;
  for (std::size_t k = 0; k < points_; ++k) {
    double pulled = pullOf(last)[k];
    sizes[k] = sizeOf(last)[k];
    for (std::size_t j = 0; j < last; ++j) {
      pulled -= factors[j] * (pullOf(last)[k] - pullOf(j)[k]);
      sizes[k] -= factors[j] * (sizeOf(last)[k] - sizeOf(j)[k]);
    }
    const double share = points[k].opening.share, weight = std::sqrt(points[k].area) / law_.onset(share);
    const double beside = weight * (pulled - pull(k, {sizes[k], share}));
    sum += beside * beside;
    if (normal == nullptr)
      continue;
    const double first = law_.onset(share), end = law_.end(share), before = part(begun)[k];
    const double steep = sizes[k] <= law_.sizeAt(before, share) ? 1.0 - before
                         : sizes[k] < end                       ? -first / (end - first)
                                                                : 0.0;
    for (std::size_t j = 0; j < last; ++j)
      slope[j] = weight * (steep * (sizeOf(last)[k] - sizeOf(j)[k]) - (pullOf(last)[k] - pullOf(j)[k]));
    for (std::size_t i = 0; i < last; ++i) {
      normal->right[i] += slope[i] * beside;
      for (std::size_t j = 0; j < last; ++j)
        normal->gram[i][j] += slope[i] * slope[j];
    }
  }
  return sum;
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
