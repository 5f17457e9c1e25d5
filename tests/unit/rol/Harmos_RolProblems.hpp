// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Functions of designs with known answers, for the tests of rol.

#include "Harmos_DesignProblem.hpp"

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace Harmos {

using Design = std::vector<double>;

/// A number in (-1, 1) for each k, the same on all machines.
inline double scattered(int k) {
  return 2.0 * std::fmod(0.5 + 0.6180339887498949 * (k + 1), 1.0) - 1.0;
}

inline Design scatteredDesign(std::size_t n, int seed) {
  Design result(n);
  for (std::size_t k = 0; k < n; ++k)
    result[k] = scattered(static_cast<int>(k) + 100 * seed);
  return result;
}

inline double product(const Design& a, const Design& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += a[k] * b[k];
  return sum;
}

inline double distance(const Design& a, const Design& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum);
}

/// A function by two lambdas, which records what it was asked.
class TestFunction : public sensitivity::DesignFunction {
 public:
  TestFunction(std::function<double(const Design&)> value, std::function<Design(const Design&)> gradient)
      : value_(std::move(value)), gradient_(std::move(gradient)) {}

  double value(const Design& design, double tolerance) override {
    designs.push_back(design);
    tolerances.push_back(tolerance);
    return value_(design);
  }
  Design gradient(const Design& design, double tolerance) override {
    gradientDesigns.push_back(design);
    gradientTolerances.push_back(tolerance);
    return gradient_(design);
  }

  std::vector<Design> designs, gradientDesigns;
  std::vector<double> tolerances, gradientTolerances;

 private:
  std::function<double(const Design&)> value_;
  std::function<Design(const Design&)> gradient_;
};

/// slope·x
inline TestFunction linearFunction(const Design& slope) {
  return {[slope](const Design& x) { return product(slope, x); }, [slope](const Design&) { return slope; }};
}

/// factor·½Σ a (x − target)²
inline TestFunction bowl(const Design& a, const Design& target, double factor = 1.0) {
  return {[=](const Design& x) {
            double sum = 0.0;
            for (std::size_t k = 0; k < x.size(); ++k)
              sum += 0.5 * a[k] * (x[k] - target[k]) * (x[k] - target[k]);
            return factor * sum;
          },
          [=](const Design& x) {
            Design result(x.size());
            for (std::size_t k = 0; k < x.size(); ++k)
              result[k] = factor * a[k] * (x[k] - target[k]);
            return result;
          }};
}

/// ½(x − target)ᵀ H (x − target) with H = QᵀDQ, D from 1 to `condition`, Q a product of reflections.
inline TestFunction skewBowl(std::size_t n, double condition, const Design& target) {
  const auto turned = [n](Design x, bool back) {
    for (int r = 0; r < 3; ++r) {
      const Design v = scatteredDesign(n, 7 + (back ? 2 - r : r));
      const double factor = 2.0 * product(v, x) / product(v, v);
      for (std::size_t k = 0; k < n; ++k)
        x[k] -= factor * v[k];
    }
    return x;
  };
  const auto stretched = [n, condition](Design x) {
    for (std::size_t k = 0; k < n; ++k)
      x[k] *= std::pow(condition, static_cast<double>(k) / static_cast<double>(n - 1));
    return x;
  };
  const auto shifted = [target](Design x) {
    for (std::size_t k = 0; k < x.size(); ++k)
      x[k] -= target[k];
    return x;
  };
  return {[=](const Design& x) {
            const Design y = turned(shifted(x), false);
            return 0.5 * product(y, stretched(y));
          },
          [=](const Design& x) { return turned(stretched(turned(shifted(x), false)), true); }};
}

/// Pressures p = b − K x of a profile x, K a smooth kernel on a line, as those of a punch on a half-plane
/// are.
struct Pressures {
  std::size_t n;
  double value(const Design& x, std::size_t i) const {
    const double s = (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n) - 1.0;
    double sum = 1.0 / std::sqrt(1.02 - s * s);
    for (std::size_t j = 0; j < n; ++j)
      sum -= kernel(i, j) * x[j];
    return sum;
  }
  double kernel(std::size_t i, std::size_t j) const {
    const double d = static_cast<double>(i > j ? i - j : j - i);
    return i == j ? 4.0 : -1.0 / (1.0 + d);
  }
  Design all(const Design& x) const {
    Design result(n);
    for (std::size_t i = 0; i < n; ++i)
      result[i] = value(x, i);
    return result;
  }
  Design transposed(const Design& y) const { // −Kᵀ y
    Design result(n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        result[j] -= kernel(i, j) * y[i];
    return result;
  }
};

/// (Σ |p|⁸/n)^(1/8)
inline TestFunction pressureNorm(const Pressures& pressures) {
  const double n = static_cast<double>(pressures.n);
  const auto sum = [n](const Design& p) {
    double result = 0.0;
    for (const double number : p)
      result += std::pow(number, 8) / n;
    return result;
  };
  return {[=](const Design& x) { return std::pow(sum(pressures.all(x)), 0.125); },
          [=](const Design& x) {
            Design p = pressures.all(x);
            const double factor = std::pow(sum(p), -0.875) / n;
            for (double& number : p)
              number = factor * std::pow(number, 7);
            return pressures.transposed(p);
          }};
}

/// Σ p/n, linear in x.
inline TestFunction meanPressure(const Pressures& pressures) {
  const double n = static_cast<double>(pressures.n);
  return {[=](const Design& x) {
            double sum = 0.0;
            for (const double number : pressures.all(x))
              sum += number / n;
            return sum;
          },
          [=](const Design&) { return pressures.transposed(Design(pressures.n, 1.0 / n)); }};
}

/// Designs within a box.
inline sensitivity::DesignProblem inBox(TestFunction& cost, std::size_t n, double start, double lower,
                                        double upper) {
  sensitivity::DesignProblem result;
  result.cost = &cost;
  result.space.start.assign(n, start);
  result.space.lower.assign(n, lower);
  result.space.upper.assign(n, upper);
  result.space.weights.assign(n, 1.0);
  return result;
}

inline sensitivity::DesignConstraint limited(const std::string& name, TestFunction& function, double lower,
                                             double upper, bool isLinear) {
  sensitivity::DesignConstraint result;
  result.name = name;
  result.function = &function;
  result.lower = lower;
  result.upper = upper;
  result.isLinear = isLinear;
  return result;
}

} // namespace Harmos
