// SPDX-License-Identifier: BSD-3-Clause
/// An application's own torn matrices: a membrane on the unit square, cut into s × s squares of n × n
/// bilinear elements, held at its left side; numbers of dofs have gaps.
#pragma once

#include <Harmos_ConstraintRow.hpp>
#include <Harmos_SubdomainInput.hpp>
#include <Teuchos_Comm.hpp>

#include <vector>

struct TornMembrane {
  int s = 3, n = 8;

  long long dof(int i, int j) const { return 1000LL * j + i; } ///< of grid point (i, j)
  double size() const { return 1.0 / (s * n); }                ///< of an element

  /// The subdomains of a rank: every comm.getSize()-th. @param stiffness of the material.
  std::vector<Harmos::feti::Subdomain> subdomains(const Teuchos::Comm<int>& comm, double stiffness,
                                                  double pressure) const {
    // Compressed rows with all nine neighbours, as a finite element code assembles them.
    const int m = n + 1;
    std::vector<int> offsets = {0}, columns;
    std::vector<double> values, load;
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) {
        double weight = 0.0;
        for (int dj = -1; dj <= 1; ++dj)
          for (int di = -1; di <= 1; ++di) {
            // Elements that both points belong to; of each the matrix is (4, −1, −2, −1)/6.
            const auto common = [&](int k, int d) { return d != 0 ? 1 : (k > 0) + (k < n); };
            if (i + di < 0 || i + di >= m || j + dj < 0 || j + dj >= m)
              continue;
            const int elements = common(i, di) * common(j, dj);
            columns.push_back((j + dj) * m + i + di);
            values.push_back(stiffness * elements *
                             (di == 0 && dj == 0   ? 4.0
                              : di != 0 && dj != 0 ? -2.0
                                                   : -1.0) /
                             6.0);
            if (di == 0 && dj == 0)
              weight = 0.25 * elements;
          }
        offsets.push_back(static_cast<int>(columns.size()));
        load.push_back(pressure * weight * size() * size());
      }
    const auto matrix = Harmos::feti::localMatrix(m * m, offsets.data(), columns.data(), values.data());

    std::vector<Harmos::feti::Subdomain> result;
    for (int p = comm.getRank(); p < s * s; p += comm.getSize()) {
      std::vector<long long> dofs;
      std::vector<Harmos::feti::FixedDof> fixed;
      for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i) {
          if (p % s == 0 && i == 0)
            fixed.push_back({j * m, 0.0});
          dofs.push_back(dof(p % s * n + i, p / s * n + j));
        }
      result.push_back(
          Harmos::feti::makeSubdomain(p, matrix, load, dofs, Harmos::feti::constantKernel(m * m), fixed));
    }
    return result;
  }

  static constexpr long long second = 1000000; ///< numbers of the dofs of a second component begin here

  /// Of a sheet whose points move in two directions, each against the stiffness of a membrane of its own.
  std::vector<Harmos::feti::Subdomain> inTwoDirections(const Teuchos::Comm<int>& comm, double firstLoad,
                                                       double secondLoad,
                                                       double secondStiffness = 1.0) const {
    std::vector<Harmos::feti::Subdomain> all = subdomains(comm, 1.0, firstLoad);
    for (Harmos::feti::Subdomain& subdomain : subdomains(comm, secondStiffness, secondLoad)) {
      subdomain.number += s * s;
      for (long long& number : subdomain.numbers)
        number += second;
      all.push_back(subdomain);
    }
    return all;
  }

  /// An obstacle below the right side, highest in the middle: −u ≤ depth + (y − ½)². All rows on rank 0.
  std::vector<Harmos::ConstraintRow> obstacle(const Teuchos::Comm<int>& comm, double depth) const {
    std::vector<Harmos::ConstraintRow> rows;
    for (int j = 0; comm.getRank() == 0 && j <= s * n; ++j) {
      Harmos::ConstraintRow row;
      row.kind = Harmos::ConstraintRow::Kind::Inequality;
      row.number = j;
      row.terms = {{dof(s * n, j), -1.0}};
      row.bound = depth + (size() * j - 0.5) * (size() * j - 0.5);
      rows.push_back(row);
    }
    return rows;
  }
};
