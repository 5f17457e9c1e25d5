// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SplineBasis.hpp"

#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace test_spline_basis {

using namespace Harmos;
using fem::Point;
using sensitivity::SplineBasis;
using sensitivity::TensorSplineBasis;

namespace {

// Rounding in some dozens of operations with numbers of order one.
constexpr double roundoff = 1e-13;

constexpr double begin = -0.7, end = 1.9;

std::vector<SplineBasis> bases() {
  std::vector<SplineBasis> result;
  for (int degree = 0; degree <= SplineBasis::mostDegree; ++degree)
    for (int pieces : {1, 2, 5})
      result.push_back(SplineBasis::uniform(degree, begin, end, pieces));
  result.push_back(SplineBasis::hats({begin, -0.5, 0.4, 0.41, end}));
  return result;
}

// Places within, none of them a knot: multiples of an irrational share.
std::vector<double> places() {
  std::vector<double> result;
  for (int k = 1; k <= 40; ++k)
    result.push_back(begin + (end - begin) * std::fmod(k * std::sqrt(2.0), 1.0));
  return result;
}

// Σ factor_i B_i, and its derivative.
double valueOf(const SplineBasis& basis, const std::function<double(int)>& factor, double x) {
  const SplineBasis::Values at = basis.at(x);
  double sum = 0.0;
  for (int i = 0; i <= basis.degree(); ++i)
    sum += factor(at.first + i) * at.values[static_cast<std::size_t>(i)];
  return sum;
}
double slopeOf(const SplineBasis& basis, const std::function<double(int)>& factor, double x) {
  const SplineBasis::Values at = basis.at(x);
  double sum = 0.0;
  for (int i = 0; i <= basis.degree(); ++i)
    sum += factor(at.first + i) * at.derivatives[static_cast<std::size_t>(i)];
  return sum;
}

double someFactor(int i) {
  return std::sin(1.0 + 3.0 * i);
}

} // namespace

TEST(SplineBasis, sizes) {
  for (int degree = 0; degree <= 3; ++degree) {
    const SplineBasis basis = SplineBasis::uniform(degree, begin, end, 5);
    EXPECT_EQ(basis.size(), 5 + degree);
    EXPECT_EQ(basis.degree(), degree);
    EXPECT_EQ(basis.begin(), begin);
    EXPECT_EQ(basis.end(), end);
  }
  EXPECT_EQ(SplineBasis::hats({0.0, 1.0, 4.0}).size(), 3);
}

TEST(SplineBasis, is_a_partition_of_unity_by_functions_that_are_not_negative) {
  for (const SplineBasis& basis : bases())
    for (double x : places()) {
      const SplineBasis::Values at = basis.at(x);
      EXPECT_GE(at.first, 0);
      EXPECT_LT(at.first + basis.degree(), basis.size());
      double slope = 0.0;
      for (std::size_t i = 0; i < at.values.size(); ++i) {
        EXPECT_GE(at.values[i], 0.0);
        slope += at.derivatives[i];
        if (static_cast<int>(i) > basis.degree()) {
          EXPECT_EQ(at.values[i], 0.0);
        }
      }
      EXPECT_NEAR(valueOf(
                      basis, [](int) { return 1.0; }, x),
                  1.0, roundoff);
      // Derivatives are of the order of degree / piece, the shortest of which has the length 0.01.
      EXPECT_NEAR(slope, 0.0, 100 * roundoff);
    }
}

// With differences of step 1e-5 within a piece: truncation below 1e-10 · third derivatives, which are those
// of cubics on pieces of 0.5, some hundreds; rounding 1e-16 / 1e-5.
TEST(SplineBasis, derivatives_are_those_of_the_values) {
  constexpr double h = 1e-5;
  for (const SplineBasis& basis : bases())
    for (double x : places()) {
      if (basis.at(x - h).first != basis.at(x + h).first)
        continue; // across a knot
      EXPECT_NEAR(slopeOf(basis, someFactor, x),
                  (valueOf(basis, someFactor, x + h) - valueOf(basis, someFactor, x - h)) / (2 * h), 1e-7)
          << "degree " << basis.degree() << " at " << x;
    }
}

// Knots are crossed with degree − 1 continuous derivatives: the step across is that of the first order in the
// distance, 2e-9 times slopes of some tens (hats: derivatives jump).
TEST(SplineBasis, is_continuous_across_knots) {
  for (int degree = 1; degree <= 3; ++degree) {
    const SplineBasis basis = SplineBasis::uniform(degree, begin, end, 5);
    for (int k = 1; k < 5; ++k) {
      const double knot = begin + (end - begin) * k / 5.0;
      EXPECT_NEAR(valueOf(basis, someFactor, knot - 1e-9), valueOf(basis, someFactor, knot + 1e-9), 1e-7);
      if (degree > 1) {
        EXPECT_NEAR(slopeOf(basis, someFactor, knot - 1e-9), slopeOf(basis, someFactor, knot + 1e-9), 1e-6);
      }
    }
  }
}

// The factors of a product of p linear functions are its polar form at the knots, Π (t_(i+k) − root_k)
// symmetrised (Ramshaw 1989); of (x − r)^p that is the plain product over the inner knots of each function.
TEST(SplineBasis, reproduces_polynomials_of_its_degree) {
  constexpr double root = 0.3;
  for (int degree = 0; degree <= 3; ++degree)
    for (int pieces : {1, 2, 5}) {
      const SplineBasis basis = SplineBasis::uniform(degree, begin, end, pieces);
      const auto factor = [&](int i) {
        double product = 1.0;
        for (int k = 1; k <= degree; ++k) { // knot i + k, open at the ends
          const int piece = std::min(std::max(i + k - degree, 0), pieces);
          product *= begin + (end - begin) * piece / pieces - root;
        }
        return product;
      };
      for (double x : places()) {
        EXPECT_NEAR(valueOf(basis, factor, x), std::pow(x - root, degree), 10 * roundoff)
            << degree << " " << pieces;
        EXPECT_NEAR(slopeOf(basis, factor, x), degree == 0 ? 0.0 : degree * std::pow(x - root, degree - 1),
                    100 * roundoff)
            << degree << " " << pieces;
      }
    }
}

TEST(SplineBasis, abscissae_give_the_coordinate_and_integrals_the_length) {
  for (const SplineBasis& basis : bases()) {
    double length = 0.0;
    for (int i = 0; i < basis.size(); ++i)
      length += basis.integral(i);
    EXPECT_NEAR(length, end - begin, roundoff);
    const auto abscissa = [&](int i) { return basis.abscissa(i); };
    if (basis.degree() > 0)
      for (double x : places())
        EXPECT_NEAR(valueOf(basis, abscissa, x), x, roundoff);
    // Each integral by midpoints; kinks and jumps of functions make it of the order of 1/points.
    constexpr int points = 10000;
    std::vector<double> sums(static_cast<std::size_t>(basis.size()), 0.0);
    for (int k = 0; k < points; ++k) {
      const SplineBasis::Values at = basis.at(begin + (end - begin) * (k + 0.5) / points);
      for (int i = 0; i <= basis.degree(); ++i)
        sums[static_cast<std::size_t>(at.first + i)] +=
            (end - begin) / points * at.values[static_cast<std::size_t>(i)];
    }
    for (int i = 0; i < basis.size(); ++i)
      EXPECT_NEAR(basis.integral(i), sums[static_cast<std::size_t>(i)], 2.0 * (end - begin) / points);
  }
  EXPECT_NEAR(SplineBasis::uniform(0, 0.0, 2.0, 2).abscissa(1), 1.5, roundoff);
}

TEST(SplineBasis, hats_have_the_values_at_their_places) {
  const std::vector<double> at = {-1.0, 0.5, 0.7, 3.0}, values = {2.0, -1.0, 4.0, 0.5};
  const SplineBasis basis = SplineBasis::hats(at);
  const auto factor = [&](int i) { return values[static_cast<std::size_t>(i)]; };
  for (std::size_t k = 0; k < at.size(); ++k) {
    EXPECT_NEAR(valueOf(basis, factor, at[k]), values[k], roundoff);
    EXPECT_NEAR(basis.abscissa(static_cast<int>(k)), at[k], roundoff);
    if (k > 0) {
      const double middle = 0.5 * (at[k - 1] + at[k]);
      EXPECT_NEAR(valueOf(basis, factor, middle), 0.5 * (values[k - 1] + values[k]), roundoff);
      EXPECT_NEAR(slopeOf(basis, factor, middle), (values[k] - values[k - 1]) / (at[k] - at[k - 1]),
                  100 * roundoff);
    }
  }
}

// At an end only its function is not zero, with the derivative to the inside; beyond it the value stays, and
// so does the derivative of what is beyond by rounding alone.
TEST(SplineBasis, ends_and_what_is_beyond) {
  for (const SplineBasis& basis : bases()) {
    for (bool isEnd : {false, true}) {
      const double x = isEnd ? end : begin, outwards = isEnd ? 1.0 : -1.0;
      const int only = isEnd ? basis.size() - 1 : 0;
      const double slope = slopeOf(basis, someFactor, x);
      if (basis.degree() > 0) {
        EXPECT_GT(std::abs(slope), 0.01);
      }
      for (double beyond : {0.0, 1e-15, 0.5, 100.0})
        EXPECT_NEAR(valueOf(basis, someFactor, x + outwards * beyond), someFactor(only), roundoff);
      EXPECT_NEAR(slopeOf(basis, someFactor, x + outwards * 1e-15), slope, 1e-12 * std::abs(slope));
      EXPECT_EQ(slopeOf(basis, someFactor, x + outwards * 1e-6), 0.0);
      EXPECT_EQ(slopeOf(basis, someFactor, x + outwards * 100.0), 0.0);
    }
  }
}

TEST(SplineBasis, errors_name_the_remedy) {
  const auto uniform = [](int degree, double a, double b, int pieces) {
    return inputErrorOf([&] { SplineBasis::uniform(degree, a, b, pieces); });
  };
  EXPECT_EQ(uniform(3, 0.0, 1.0, 1), "");
  for (int degree : {-1, 4})
    EXPECT_TRUE(contains(uniform(degree, 0.0, 1.0, 1), "use degree 0 (constants), 1 (hats), 2 or 3"));
  EXPECT_TRUE(contains(uniform(1, 0.0, 1.0, 0), "on 0 pieces of an interval; give at least one"));
  EXPECT_TRUE(contains(uniform(1, 1.0, 1.0, 2), "two finite ends in ascending order"));
  EXPECT_TRUE(contains(uniform(1, 2.0, 1.0, 2), "two finite ends in ascending order"));
  EXPECT_TRUE(contains(uniform(1, std::nan(""), 1.0, 2), "two finite ends in ascending order"));
  EXPECT_TRUE(contains(uniform(1, 0.0, INFINITY, 2), "two finite ends in ascending order"));
  const auto hats = [](const std::vector<double>& at) {
    return inputErrorOf([&] { SplineBasis::hats(at); });
  };
  EXPECT_TRUE(contains(hats({1.0}), "over 1 places; give at least two"));
  EXPECT_TRUE(contains(hats({0.0, 1.0, 1.0}), "place 2, 1.000000e+00, is not finite or not above"));
  EXPECT_TRUE(contains(hats({std::nan(""), 1.0}), "place 0"));
  const SplineBasis basis = SplineBasis::uniform(1, 0.0, 1.0, 1);
  const auto product = [](const std::vector<SplineBasis>& factors, const std::vector<int>& axes) {
    return inputErrorOf([&] { TensorSplineBasis(factors, axes); });
  };
  EXPECT_EQ(product({basis, basis}, {2, 0}), "");
  EXPECT_TRUE(contains(product({}, {}), "products of 0 splines along 0 axes; give one or two"));
  EXPECT_TRUE(contains(product({basis, basis, basis}, {0, 1, 2}), "give one or two, each with its axis"));
  EXPECT_TRUE(contains(product({basis, basis}, {0}), "each with its axis"));
  EXPECT_TRUE(contains(product({basis}, {3}), "along axis 3; axes are 0 (x), 1 (y) and 2 (z)"));
  EXPECT_TRUE(contains(product({basis, basis}, {1, 1}), "give each its own axis"));
}

// Function i + n₀ j is the product, along axes in any order; gradients are those of the products.
TEST(TensorSplineBasis, is_the_product) {
  const SplineBasis first = SplineBasis::uniform(2, begin, end, 3),
                    second = SplineBasis::hats({0.0, 0.3, 1.0});
  const TensorSplineBasis product({first, second}, {2, 0});
  EXPECT_EQ(product.size(), first.size() * second.size());
  EXPECT_EQ(product.factors(), 2u);
  EXPECT_EQ(product.axis(1), 0);
  EXPECT_EQ(product.basis(1).size(), 3);
  for (double z : places()) {
    const Point x = {0.8 * (z - begin) / (end - begin), 77.0, z};
    const TensorSplineBasis::Values at = product.at(x);
    const SplineBasis::Values a = first.at(x[2]), b = second.at(x[0]);
    ASSERT_EQ(at.count, 6u);
    double sum = 0.0;
    for (std::size_t k = 0; k < at.count; ++k) {
      if (k > 0) {
        EXPECT_LT(at.functions[k - 1], at.functions[k]);
      }
      const auto i = static_cast<std::size_t>(at.functions[k] % first.size() - a.first),
                 j = static_cast<std::size_t>(at.functions[k] / first.size() - b.first);
      ASSERT_LT(i, 3u);
      ASSERT_LT(j, 2u);
      EXPECT_NEAR(at.values[k], a.values[i] * b.values[j], roundoff);
      EXPECT_NEAR(at.gradients[k][0], a.values[i] * b.derivatives[j], roundoff);
      EXPECT_EQ(at.gradients[k][1], 0.0);
      EXPECT_NEAR(at.gradients[k][2], a.derivatives[i] * b.values[j], roundoff);
      sum += at.values[k];
    }
    EXPECT_NEAR(sum, 1.0, roundoff);
  }
  double area = 0.0;
  for (int k = 0; k < product.size(); ++k) {
    area += product.integral(k);
    EXPECT_EQ(product.abscissa(k),
              (Point{second.abscissa(k / first.size()), 0.0, first.abscissa(k % first.size())}));
  }
  EXPECT_NEAR(area, end - begin, roundoff);
}

TEST(TensorSplineBasis, of_one_is_that_along_its_axis) {
  const SplineBasis basis = SplineBasis::uniform(3, begin, end, 4);
  const TensorSplineBasis single({basis}, {1});
  EXPECT_EQ(single.size(), 7);
  const TensorSplineBasis::Values at = single.at({9.0, 0.4, 9.0});
  const SplineBasis::Values expected = basis.at(0.4);
  ASSERT_EQ(at.count, 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(at.functions[k], expected.first + static_cast<int>(k));
    EXPECT_EQ(at.values[k], expected.values[k]);
    EXPECT_EQ(at.gradients[k], (Point{0.0, expected.derivatives[k], 0.0}));
  }
  EXPECT_EQ(single.abscissa(2), (Point{0.0, basis.abscissa(2), 0.0}));
  EXPECT_EQ(single.integral(2), basis.integral(2));
}

} // namespace test_spline_basis
