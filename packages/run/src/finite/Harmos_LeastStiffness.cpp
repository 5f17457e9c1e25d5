// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LeastStiffness.hpp"

#include "Harmos_Errors.hpp"

#include <Teuchos_LAPACK.hpp>

#include <cmath>
#include <vector>

namespace Harmos::run {
namespace {

void add(double factor, const feti::TornVector& other, feti::TornVector& to) {
  for (std::size_t i = 0; i < to.size(); ++i)
    for (std::size_t k = 0; k < to[i].size(); ++k)
      to[i][k] += factor * other[i][k];
}

void scale(double factor, feti::TornVector& values) {
  for (std::vector<double>& part : values)
    for (double& value : part)
      value *= factor;
}

// The eigenvalues of a symmetric matrix of order n, rising, and in its place their vectors.
std::vector<double> eigenvalues(std::vector<double>& matrix, int n) {
  std::vector<double> values(static_cast<std::size_t>(n)), work(static_cast<std::size_t>(8 * n));
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('V', 'L', n, matrix.data(), n, values.data(), work.data(), 8 * n,
                                      &info);
  HARMOS_REQUIRE(info == 0, "eigenvalues of a small matrix are not to be had");
  return values;
}

// Orthonormal motions with their images.
class MotionBasis {
 public:
  explicit MotionBasis(const StiffnessActions& actions) : actions_(actions) {}

  std::size_t size() const { return motions_.size(); }
  // Whether it is no sum of those before.
  bool add(feti::TornVector motion) {
    const double before = normalise(motion);
    for (std::size_t k = 0; k < size(); ++k)
      run::add(-actions_.product(motion, references_[k]), motions_[k], motion);
    constexpr double dependent = 1e-3;
    if (!(before > 0.0) || !(normalise(motion) > dependent))
      return false;
    references_.push_back(actions_.reference(motion));
    wholes_.push_back(actions_.whole(motion));
    motions_.push_back(std::move(motion));
    return true;
  }
  // What the reference has more than the whole, along the last one.
  feti::TornVector residual() const {
    feti::TornVector force = references_.back();
    run::add(-1.0, wholes_.back(), force);
    return force;
  }
  // @param most the largest value of all.
  LeastStiffness least(double& most) const {
    const std::size_t n = size();
    std::vector<double> matrix(n * n);
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i)
        matrix[j * n + i] =
            0.5 * (actions_.product(motions_[i], wholes_[j]) + actions_.product(motions_[j], wholes_[i]));
    const std::vector<double> values = eigenvalues(matrix, static_cast<int>(n));
    LeastStiffness result;
    result.value = values.front();
    most = values.back();
    result.motion = motions_.front();
    scale(matrix[0], result.motion);
    for (std::size_t k = 1; k < n; ++k)
      run::add(matrix[k], motions_[k], result.motion);
    return result;
  }

 private:
  // @return the length that it had.
  double normalise(feti::TornVector& motion) const {
    const double square = actions_.product(motion, actions_.reference(motion));
    const double length = square > 0.0 ? std::sqrt(square) : 0.0;
    if (length > 0.0)
      scale(1.0 / length, motion);
    return length;
  }

  const StiffnessActions& actions_;
  std::vector<feti::TornVector> motions_, references_, wholes_;
};

} // namespace

std::optional<LeastStiffness> leastStiffness(const StiffnessActions& actions, feti::TornVector force) {
  constexpr std::size_t most = 6;
  // Where stresses change stiffness by so little, motions more would hardly bring it below zero.
  constexpr double little = 0.5;
  MotionBasis basis(actions);
  std::optional<LeastStiffness> result;
  while (basis.size() < most) {
    std::optional<feti::TornVector> motion = actions.motion(force);
    if (!motion || !basis.add(std::move(*motion)))
      break;
    double largest = 0.0;
    result = basis.least(largest);
    if (result->isBelowZero() || (result->value > 1.0 - little && largest < 1.0 + little))
      break;
    force = basis.residual();
  }
  return result;
}

} // namespace Harmos::run
