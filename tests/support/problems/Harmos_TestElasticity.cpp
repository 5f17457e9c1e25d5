// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestElasticity.hpp"

#include <cmath>

namespace Harmos {

TestSolid testSolid(int dimension, int n, double modulus, bool isHinge) {
  TestSolid solid;
  solid.dimension = dimension;
  const int depth = dimension == 3 ? n : 0;
  // A hinge: two blocks side by side, the second one's nodes numbered after the first one's, one in common.
  const int blocks = isHinge ? 2 : 1;
  std::vector<MatrixEntry> entries;
  int next = 0;
  for (int block = 0; block < blocks; ++block) {
    std::vector<int> number;
    for (int k = 0; k <= depth; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          const bool common = block == 1 && i == 0 && j == 0 && k == 0;
          number.push_back(common ? n : next); // node n is the lower right corner of the first block
          if (common)
            continue;
          ++next;
          solid.nodes.push_back({static_cast<double>(i + block * n) / n, static_cast<double>(j) / n,
                                 static_cast<double>(k) / n});
        }
    const auto at = [&](int i, int j, int k) {
      return number[static_cast<std::size_t>((k * (n + 1) + j) * (n + 1) + i)];
    };
    const auto addMember = [&](int a, int b) {
      const auto& x = solid.nodes[static_cast<std::size_t>(a)];
      const auto& y = solid.nodes[static_cast<std::size_t>(b)];
      std::array<double, 3> d = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
      const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      for (int p = 0; p < dimension; ++p)
        for (int q = 0; q < dimension; ++q) {
          const double value = modulus / length * d[static_cast<std::size_t>(p)] *
                               d[static_cast<std::size_t>(q)] / (length * length);
          entries.push_back({dimension * a + p, dimension * a + q, value});
          entries.push_back({dimension * b + p, dimension * b + q, value});
          entries.push_back({dimension * a + p, dimension * b + q, -value});
          entries.push_back({dimension * b + p, dimension * a + q, -value});
        }
    };
    for (int k = 0; k <= depth; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
          for (int dk = 0; dk <= (depth > 0 ? 1 : 0); ++dk)
            for (int dj = -1; dj <= 1; ++dj)
              for (int di = -1; di <= 1; ++di) {
                const bool forward = dk > 0 || dj > 0 || (dj == 0 && di > 0);
                const int p = i + di, q = j + dj, r = k + dk;
                if (forward && p >= 0 && q >= 0 && p <= n && q <= n && r <= depth)
                  addMember(at(i, j, k), at(p, q, r));
              }
  }
  const int dofs = dimension * next;
  solid.stiffness = makeLocalMatrix(dofs, std::move(entries));
  solid.motions.rows = dofs;
  solid.motions.columns = dimension == 2 ? 3 : 6;
  for (int k = 0; k < solid.motions.columns; ++k)
    for (const std::array<double, 3>& x : solid.nodes) {
      std::array<double, 3> u = {0.0, 0.0, 0.0};
      if (k < dimension)
        u[static_cast<std::size_t>(k)] = 1.0;
      else if (dimension == 2 || k == 3)
        u = {-x[1], x[0], 0.0};
      else if (k == 4)
        u = {0.0, -x[2], x[1]};
      else
        u = {x[2], 0.0, -x[0]};
      for (int p = 0; p < dimension; ++p)
        solid.motions.values.push_back(u[static_cast<std::size_t>(p)]);
    }
  return solid;
}

} // namespace Harmos
