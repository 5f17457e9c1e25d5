// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

namespace Harmos {

constexpr double changedTolerance = 1e-10; ///< that solvers of changed models have
/// ‖u − u*‖ by the condition of these F, a hundred at most, and norms.
constexpr double changedBound = 1e3 * changedTolerance;

/// Displacements and forces of a solve are those of the undecomposed problem.
inline void expectReference(const TestModel& model, feti::FetiSolver& solver, const std::string& what) {
  const feti::SolveReport& report = solver.solve();
  ASSERT_TRUE(report.converged) << what << ": " << report.reason;
  const ReferenceSolution reference = referenceSolution(*testComm(), model.subdomains, model.rows);
  ASSERT_TRUE(reference.solvable) << what;
  EXPECT_LE(deviation(reference, solver).largest(), changedBound) << what;
}

/// Each subdomain's matrix times a factor, in objects of their own.
inline TestModel scaled(TestModel model, const std::function<double(long long)>& factor) {
  for (feti::Subdomain& subdomain : model.subdomains) {
    auto matrix = std::make_shared<LocalMatrix>(*subdomain.stiffness);
    for (double& value : matrix->values)
      value *= factor(subdomain.number);
    subdomain.stiffness = matrix;
  }
  return model;
}

/// Eight subdomains, none like another.
inline TestModel different() {
  return scaled(testModel(2, 4), [](long long number) { return 1.0 + 0.25 * static_cast<double>(number); });
}

inline std::vector<std::shared_ptr<const LocalMatrix>> matricesOf(const TestModel& model) {
  std::vector<std::shared_ptr<const LocalMatrix>> matrices;
  for (const feti::Subdomain& subdomain : model.subdomains)
    matrices.push_back(subdomain.stiffness);
  return matrices;
}

inline std::vector<std::shared_ptr<const std::vector<double>>> loadsOf(const TestModel& model) {
  std::vector<std::shared_ptr<const std::vector<double>>> loads;
  for (const feti::Subdomain& subdomain : model.subdomains)
    loads.push_back(subdomain.load);
  return loads;
}

/// K − 2aaᵀ, a = e₆ − e₇: its graph and kernel, and indefinite.
inline TestModel broken(TestModel model, long long number) {
  for (feti::Subdomain& subdomain : model.subdomains)
    if (subdomain.number == number) {
      auto matrix = std::make_shared<LocalMatrix>(*subdomain.stiffness);
      double largest = matrix->maxNorm();
      for (const auto& [i, j, value] : {std::tuple{6, 6, -1.0}, {6, 7, 1.0}, {7, 6, 1.0}, {7, 7, -1.0}})
        for (std::size_t k = matrix->offsets[static_cast<std::size_t>(i)];
             k < matrix->offsets[static_cast<std::size_t>(i) + 1]; ++k)
          if (matrix->columns[k] == j)
            matrix->values[k] += 0.7 * largest * value;
      subdomain.stiffness = matrix;
    }
  return model;
}

} // namespace Harmos
