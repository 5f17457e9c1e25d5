// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace Harmos::sensitivity {

/// B-splines on an interval: the functions whose factors are a design.
///
/// On the knots t_0 ≤ … ≤ t_(n+p), of which the first and the last p + 1 are the ends of the interval (open
/// knots), n functions of degree p; function i is above zero between t_i and t_(i+p+1), and their sum is 1
/// everywhere (Piegl and Tiller: The NURBS Book, 1997, section 2.2). Degree 0: constants; 1: hats, whose
/// factors are values at the knots; 2 and 3: once and twice continuously differentiable. Local.
/// Guarded by tests/unit/sensitivity/test_spline_basis.cpp.
class SplineBasis {
 public:
  static constexpr int mostDegree = 3;

  /// The functions that are not zero at a point, first, …, first + degree, and their derivatives.
  struct Values {
    int first = 0;
    std::array<double, mostDegree + 1> values{}, derivatives{};
  };

  /// On `pieces` equal pieces of [begin, end]: pieces + degree functions.
  /// @throws InputError for degrees other than 0 to 3, no pieces, ends that are not finite or not in order.
  static SplineBasis uniform(int degree, double begin, double end, int pieces);
  /// Hats over given places, one for each: the polygon through given values.
  /// @throws InputError for less than two places, and places that are not finite or do not rise.
  static SplineBasis hats(const std::vector<double>& places);

  int degree() const { return degree_; }
  int size() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  double begin() const { return knots_.front(); }
  double end() const { return knots_.back(); }

  /// At knots within, where derivatives of hats and constants themselves jump, the values to the right of it.
  /// Beyond the ends the functions go on as constants: values of the end, derivatives zero; but what is
  /// beyond by no more than rounding counts as the end, with the derivatives to its inside.
  Values at(double x) const;

  /// Greville's abscissa of a function, the mean of its inner knots: factors equal to these give x itself,
  /// for degrees from 1 on; of constants the middle of the piece. Where a factor is drawn or listed.
  double abscissa(int function) const;
  /// Integral of a function over the interval.
  double integral(int function) const;

 private:
  SplineBasis(int degree, std::vector<double> knots) : degree_(degree), knots_(std::move(knots)) {}

  int degree_;
  std::vector<double> knots_;
};

/// One basis along a coordinate axis, or products of two along two of them: function i + n₀ j is the product
/// of function i of the first and j of the second. Local. Guarded by
/// tests/unit/sensitivity/test_spline_basis.cpp.
class TensorSplineBasis {
 public:
  static constexpr std::size_t most = (SplineBasis::mostDegree + 1) * (SplineBasis::mostDegree + 1);

  /// The functions that may not be zero at a point, rising.
  struct Values {
    std::size_t count = 0;
    std::array<int, most> functions{};
    std::array<double, most> values{};
    std::array<fem::Point, most> gradients{}; ///< zero along axes without a basis
  };

  /// @param axes of the bases: 0, 1, 2 for x, y, z.
  /// @throws InputError for other than one or two bases, as many axes, each another one of the three.
  TensorSplineBasis(std::vector<SplineBasis> bases, std::vector<int> axes);

  int size() const;
  std::size_t factors() const { return bases_.size(); }
  const SplineBasis& basis(std::size_t factor) const { return bases_[factor]; }
  int axis(std::size_t factor) const { return axes_[factor]; }

  Values at(const fem::Point& x) const;
  /// Greville's abscissae of a function; zero along axes without a basis.
  fem::Point abscissa(int function) const;
  /// Integral of a function over the interval or rectangle.
  double integral(int function) const;

 private:
  std::vector<SplineBasis> bases_;
  std::vector<int> axes_;
};

} // namespace Harmos::sensitivity
