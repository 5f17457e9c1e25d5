// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SplineBasis.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace Harmos::sensitivity {
namespace {

// Points that are computed as the end of an interval differ from it by some units in the last place of the
// coordinates.
constexpr double roundoff = 1e-12;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

} // namespace

SplineBasis SplineBasis::uniform(int degree, double begin, double end, int pieces) {
  if (degree < 0 || degree > mostDegree)
    throw InputError("splines of degree " + std::to_string(degree) +
                     "; use degree 0 (constants), 1 (hats), 2 or 3");
  if (pieces < 1)
    throw InputError("splines on " + std::to_string(pieces) + " pieces of an interval; give at least one");
  if (!std::isfinite(begin) || !std::isfinite(end) || !(begin < end))
    throw InputError("splines on an interval from " + scientific(begin, 6) + " to " + scientific(end, 6) +
                     "; give two finite ends in ascending order");
  std::vector<double> knots(index(degree), begin);
  for (int k = 0; k < pieces; ++k)
    knots.push_back(begin + (end - begin) * k / pieces);
  knots.insert(knots.end(), index(degree) + 1, end);
  return {degree, std::move(knots)};
}

SplineBasis SplineBasis::hats(const std::vector<double>& places) {
  if (places.size() < 2)
    throw InputError("hat functions over " + std::to_string(places.size()) +
                     " places; give at least two, the ends of the interval");
  for (std::size_t k = 0; k < places.size(); ++k)
    if (!std::isfinite(places[k]) || (k > 0 && !(places[k - 1] < places[k])))
      throw InputError("hat functions: place " + std::to_string(k) + ", " + scientific(places[k], 6) +
                       ", is not finite or not above the previous one; give ascending places");
  std::vector<double> knots = {places.front()};
  knots.insert(knots.end(), places.begin(), places.end());
  knots.push_back(places.back());
  return {1, std::move(knots)};
}

// The recurrence of Cox and de Boor, which needs no division by zero: algorithm A2.2 of Piegl and Tiller. The
// derivatives are differences of the functions of the degree before (their equation 2.7).
SplineBasis::Values SplineBasis::at(double x) const {
  const std::size_t p = index(degree_);
  const double tolerance = roundoff * std::max({std::abs(begin()), std::abs(end()), end() - begin()});
  const bool isBeyond = x < begin() - tolerance || x > end() + tolerance;
  x = std::clamp(x, begin(), end());
  // The piece [t_s, t_(s+1)) that holds x; the last one holds the end.
  const auto first = knots_.begin() + static_cast<std::ptrdiff_t>(p) + 1;
  const auto last = knots_.end() - static_cast<std::ptrdiff_t>(p) - 1;
  const auto s = static_cast<std::size_t>(std::upper_bound(first, last, x) - knots_.begin()) - 1;
  Values result;
  result.first = static_cast<int>(s - p);
  std::array<double, mostDegree + 1>& values = result.values;
  values[0] = 1.0;
  for (std::size_t j = 1; j <= p; ++j) {
    double saved = 0.0, slope = 0.0;
    for (std::size_t r = 0; r < j; ++r) {
      const double right = knots_[s + r + 1], left = knots_[s + 1 + r - j];
      const double share = values[r] / (right - left);
      if (j == p && !isBeyond) {
        const double change = static_cast<double>(p) * share;
        result.derivatives[r] = slope - change;
        slope = change;
        result.derivatives[r + 1] = slope;
      }
      values[r] = saved + (right - x) * share;
      saved = (x - left) * share;
    }
    values[j] = saved;
  }
  return result;
}

double SplineBasis::abscissa(int function) const {
  const std::size_t i = index(function), p = index(degree_);
  if (p == 0)
    return 0.5 * (knots_[i] + knots_[i + 1]);
  double sum = 0.0;
  for (std::size_t k = i + 1; k <= i + p; ++k)
    sum += knots_[k];
  return sum / static_cast<double>(p);
}

double SplineBasis::integral(int function) const {
  const std::size_t i = index(function), p = index(degree_);
  return (knots_[i + p + 1] - knots_[i]) / static_cast<double>(p + 1);
}

TensorSplineBasis::TensorSplineBasis(std::vector<SplineBasis> bases, std::vector<int> axes)
    : bases_(std::move(bases)), axes_(std::move(axes)) {
  if (bases_.empty() || bases_.size() > 2 || bases_.size() != axes_.size())
    throw InputError("products of " + std::to_string(bases_.size()) + " splines along " +
                     std::to_string(axes_.size()) + " axes; give one or two, each with its axis");
  for (int axis : axes_)
    if (axis < 0 || axis > 2)
      throw InputError("splines along axis " + std::to_string(axis) + "; axes are 0 (x), 1 (y) and 2 (z)");
  if (axes_.size() == 2 && axes_[0] == axes_[1])
    throw InputError("both splines of a product run along axis " + std::to_string(axes_[0]) +
                     "; give each its own axis");
}

int TensorSplineBasis::size() const {
  int product = 1;
  for (const SplineBasis& basis : bases_)
    product *= basis.size();
  return product;
}

TensorSplineBasis::Values TensorSplineBasis::at(const fem::Point& x) const {
  const SplineBasis& inner = bases_.front();
  const SplineBasis::Values a = inner.at(x[index(axes_[0])]);
  // A single basis is a product with the constant 1.
  SplineBasis::Values b;
  b.values[0] = 1.0;
  int outer = 1;
  if (bases_.size() == 2) {
    b = bases_[1].at(x[index(axes_[1])]);
    outer = bases_[1].degree() + 1;
  }
  Values result;
  for (int j = 0; j < outer; ++j)
    for (int i = 0; i <= inner.degree(); ++i) {
      const std::size_t k = result.count++;
      result.functions[k] = a.first + i + inner.size() * (b.first + j);
      result.values[k] = a.values[index(i)] * b.values[index(j)];
      result.gradients[k][index(axes_[0])] = a.derivatives[index(i)] * b.values[index(j)];
      if (bases_.size() == 2)
        result.gradients[k][index(axes_[1])] = a.values[index(i)] * b.derivatives[index(j)];
    }
  return result;
}

fem::Point TensorSplineBasis::abscissa(int function) const {
  const int n = bases_[0].size();
  fem::Point x{};
  x[index(axes_[0])] = bases_[0].abscissa(function % n);
  if (bases_.size() == 2)
    x[index(axes_[1])] = bases_[1].abscissa(function / n);
  return x;
}

double TensorSplineBasis::integral(int function) const {
  const int n = bases_[0].size();
  return bases_[0].integral(function % n) * (bases_.size() == 2 ? bases_[1].integral(function / n) : 1.0);
}

} // namespace Harmos::sensitivity
