// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AnswerSpan.hpp"

#include "Harmos_SolutionHistory.hpp"

#include <Teuchos_LAPACK.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace Harmos::run {
namespace {

using Vector = AnswerSpan::Vector;

constexpr std::size_t mostDirections = 12;
// How much further than answers have been a combination may go.
constexpr double far = 10.0;
// What an answer's tolerance leaves of openings, in terms of how far springs are stretched: bodies move a
// hundred times as far as those where these are as stiff as they are to be. (On composites of 16 and 100
// fibres 10 to 1000 differ by a quarter in products.)
constexpr double leftOfOpenings = 300.0;

double product(const Vector& a, const Vector& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += a[k] * b[k];
  return sum;
}

void addTo(Vector& sum, double factor, const Vector& more) {
  for (std::size_t k = 0; k < sum.size(); ++k)
    sum[k] += factor * more[k];
}

double norm(const Vector& v) {
  return std::sqrt(product(v, v));
}

double normWhere(const std::vector<bool>& places, const Vector& v) {
  double sum = 0.0;
  for (std::size_t j = 0; j < v.size(); ++j)
    sum += places[j] ? v[j] * v[j] : 0.0;
  return std::sqrt(sum);
}

} // namespace

AnswerSpan::AnswerSpan(const KeyedNumbers& rows, Vector weights)
    : rows_(rows), weights_(std::move(weights)) {}

double AnswerSpan::dot(const Vector& a, const Vector& b) const {
  Vector sum = {0.0};
  for (std::size_t k = 0; k < a.size(); ++k)
    sum[0] += weights_[k] * a[k] * b[k];
  rows_.sum(sum);
  return sum[0];
}

void AnswerSpan::begin() {
  last_ = {};
  hasLast_ = false;
  forget();
}

void AnswerSpan::Pair::add(double factor, const Pair& more) {
  addTo(openings, factor, more.openings);
  addTo(forces, factor, more.forces);
  addTo(mu, factor, more.mu);
  if (!multiplier.is_null())
    multiplier->update(factor, *more.multiplier, 1.0);
}

void AnswerSpan::Pair::scale(double factor) {
  for (Vector* part : {&openings, &forces, &mu})
    for (double& entry : *part)
      entry *= factor;
  if (!multiplier.is_null())
    multiplier->scale(factor);
}

AnswerSpan::Pair AnswerSpan::copy(const Pair& pair) {
  Pair result = pair;
  if (!pair.multiplier.is_null())
    result.multiplier = Teuchos::rcp(new MultiVector(*pair.multiplier, Teuchos::Copy));
  return result;
}

void AnswerSpan::add(const Vector& openings, const Vector& forces, const feti::WarmStart& multipliers,
                     double tolerance) {
  Pair next = {openings, forces, multipliers.mu, Teuchos::null, 0.0};
  if (!multipliers.multiplier.is_null())
    next.multiplier = Teuchos::rcp(new MultiVector(*multipliers.multiplier, Teuchos::Copy));
  if (hasLast_) {
    Pair change = copy(next);
    change.add(-1.0, last_);
    // Twice, for rounding errors (Björck: Numerical Methods for Least Squares Problems, 1996, 2.4).
    for (int pass = 0; pass < 2; ++pass)
      for (const Pair& direction : directions_)
        change.add(-dot(direction.openings, change.openings), direction);
    const double length = std::sqrt(dot(change.openings, change.openings));
    Vector stretch2 = {0.0};
    for (std::size_t k = 0; k < forces.size(); ++k)
      stretch2[0] += forces[k] * forces[k] / weights_[k];
    rows_.sum(stretch2);
    if (length > leftOfOpenings * tolerance * std::sqrt(stretch2[0])) {
      change.scale(1.0 / length);
      change.reach = length;
      if (directions_.size() == mostDirections)
        directions_.erase(directions_.begin());
      directions_.push_back(std::move(change));
    }
  }
  last_ = std::move(next);
  hasLast_ = true;
}

Vector AnswerSpan::at(const Vector& c, bool ofForces) const {
  Vector sum = ofForces ? last_.forces : last_.openings;
  for (std::size_t j = 0; j < c.size(); ++j)
    addTo(sum, c[j], ofForces ? directions_[j].forces : directions_[j].openings);
  return sum;
}

Vector AnswerSpan::gradient(const Law& law, const Vector& c) const {
  Vector rest = law(at(c, false));
  addTo(rest, -1.0, at(c, true));
  Vector result;
  for (const Pair& direction : directions_)
    result.push_back(product(direction.openings, rest));
  rows_.sum(result);
  return result;
}

// −|H|⁻¹g where c is free, H by differences of the gradient.
Vector AnswerSpan::direction(const Law& law, const Vector& c, const Vector& gradientHere,
                             const std::vector<bool>& isFree) const {
  std::vector<std::size_t> places;
  for (std::size_t j = 0; j < c.size(); ++j)
    if (isFree[j])
      places.push_back(j);
  const std::size_t n = places.size();
  if (n == 0)
    return Vector(c.size(), 0.0);
  constexpr double small = 1e-6;
  const double step = small * std::sqrt(dot(last_.openings, last_.openings));
  Vector matrix(n * n);
  for (std::size_t j = 0; j < n; ++j) {
    Vector moved = c;
    moved[places[j]] += step;
    const Vector there = gradient(law, moved);
    for (std::size_t i = 0; i < n; ++i) {
      const double half = 0.5 * (there[places[i]] - gradientHere[places[i]]) / step;
      matrix[i * n + j] += half;
      matrix[j * n + i] += half;
    }
  }
  Vector eigenvalues(n), work(8 * (n + 1));
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('V', 'U', static_cast<int>(n), matrix.data(), static_cast<int>(n),
                                      eigenvalues.data(), work.data(), static_cast<int>(work.size()), &info);
  Vector result(c.size(), 0.0);
  double most = 0.0;
  for (double value : eigenvalues)
    most = std::max(most, std::abs(value));
  if (info != 0 || !(most > 0.0))
    return result;
  constexpr double least = 1e-10; // of the largest
  for (std::size_t k = 0; k < n; ++k) {
    double along = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      along += matrix[k * n + i] * gradientHere[places[i]];
    const double value = std::max(std::abs(eigenvalues[k]), least * most);
    for (std::size_t i = 0; i < n; ++i)
      result[places[i]] -= along / value * matrix[k * n + i];
  }
  return result;
}

// Of p from c on, up to where answers say something; what is in the way is not free any more.
double AnswerSpan::lengthWithin(const Vector& c, const Vector& p, std::vector<bool>& isFree) const {
  double length = 1.0;
  std::size_t limiting = p.size();
  for (std::size_t j = 0; j < p.size(); ++j) {
    const double most = far * directions_[j].reach;
    if (isFree[j] && std::abs(c[j] + length * p[j]) > most) {
      length = std::max(0.0, (p[j] > 0.0 ? most - c[j] : most + c[j]) / std::abs(p[j]));
      limiting = j;
    }
  }
  if (limiting < p.size())
    isFree[limiting] = false;
  return length;
}

AnswerSpan::Found AnswerSpan::settle(const Law& law) const {
  Vector c(directions_.size());
  if (c.empty() || !(dot(last_.openings, last_.openings) > 0.0))
    return {last_.openings, {}};
  constexpr int mostIterations = 50, mostCuts = 20;
  constexpr double enough = 1e-4, flat = 0.9;
  std::vector<bool> isFree(c.size(), true);
  Vector g = gradient(law, c);
  const double first = norm(g);
  for (int k = 0; k < mostIterations; ++k) {
    const Vector p = direction(law, c, g, isFree);
    const double slope = product(p, g);
    if (!(slope < 0.0) || normWhere(isFree, g) <= enough * first)
      break;
    const double length = lengthWithin(c, p, isFree);
    // E has no value where modes of opening change; its slope has one. Along p it is to end flatter, or to
    // go on down.
    Vector next, there;
    bool isFound = false;
    for (int cut = 0; cut < mostCuts && !isFound; ++cut) {
      next = c;
      addTo(next, std::ldexp(length, -cut), p);
      there = gradient(law, next);
      isFound = product(p, there) <= flat * std::abs(slope);
    }
    if (!isFound)
      break;
    c = next;
    g = there;
  }
  if (norm(g) > first) // down, but where errors of differences say that it is
    return {last_.openings, {}};
  Pair found = copy(last_);
  for (std::size_t j = 0; j < c.size(); ++j)
    found.add(c[j], directions_[j]);
  return {found.openings, {found.multiplier, found.mu}};
}

void AnswerSpan::exchange(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem) {
  std::size_t count = directions_.size();
  archive.number("directions of interfaces", count);
  archive.number("answers of interfaces", hasLast_);
  if (archive.isReading()) {
    directions_.assign(count, {});
    last_ = {};
  }
  for (std::size_t k = 0; k < count; ++k)
    exchange(archive, problem, directions_[k], "direction of interfaces " + std::to_string(k));
  if (hasLast_)
    exchange(archive, problem, last_, "answer of interfaces");
}

void AnswerSpan::exchange(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem,
                          Pair& pair, const std::string& name) const {
  pair.openings.resize(rows_.size());
  pair.forces.resize(rows_.size());
  rows_.exchange(archive, name + ", openings", "interfaces", pair.openings);
  rows_.exchange(archive, name + ", forces", "interfaces", pair.forces);
  archive.number(name + ", reach", pair.reach);
  feti::WarmStart multipliers = {pair.multiplier, pair.mu};
  feti::exchange(archive, problem, name, multipliers);
  if (!multipliers.multiplier.is_null())
    pair.multiplier = Teuchos::rcp(new MultiVector(*multipliers.multiplier, Teuchos::Copy));
  pair.mu = multipliers.mu;
}

} // namespace Harmos::run
