// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_TestComm.hpp"

#include <vector>

namespace Harmos {

/// The two-membrane model of the paper as raw input of the feti package.
struct TestModel {
  std::vector<feti::Subdomain> subdomains;
  std::vector<ConstraintRow> rows;
};

/// @param s 1/H; @param n H/h; @param tied equalities in the place of the inequalities.
TestModel testModel(int s, int n, bool tied = false);

/// Changes a copy of a load, which subdomains may share.
template<class Change>
void changeLoad(feti::Subdomain& subdomain, Change&& change) {
  auto load = std::make_shared<std::vector<double>>(*subdomain.load);
  change(*load);
  subdomain.load = load;
}

/// A dense matrix, column after column, for comparisons on small problems.
struct Dense {
  int rows = 0;
  int columns = 0;
  std::vector<double> values;
  Dense(int m, int n)
      : rows(m), columns(n), values(static_cast<std::size_t>(m) * static_cast<std::size_t>(n), 0.0) {}
  double& operator()(int i, int j) {
    return values[static_cast<std::size_t>(j) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(i)];
  }
  double operator()(int i, int j) const {
    return values[static_cast<std::size_t>(j) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(i)];
  }
};

/// Eigenvalues of a symmetric matrix in rising order.
std::vector<double> eigenvalues(Dense matrix);

/// Solution of a square system by elimination with partial pivoting; empty if it is singular.
std::vector<double> solveDense(Dense matrix, std::vector<double> rhs);

} // namespace Harmos
