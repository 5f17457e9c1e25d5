// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Drift.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PivotedCholesky.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::run {
namespace {

// The longest side of a box around the bodies.
double extentOf(const Teuchos::Comm<int>& comm, const std::vector<scene::OwnedSubdomain>& owned) {
  std::vector<double> ends(6, -std::numeric_limits<double>::infinity()); // −x, −y, −z, x, y, z at most
  for (const scene::OwnedSubdomain& item : owned)
    for (const int node : item.mesh.mesh->boundary) {
      const fem::Point x = item.mesh.position(node);
      for (std::size_t d = 0; d < 3; ++d) {
        ends[d] = std::max(ends[d], -x[d]);
        ends[3 + d] = std::max(ends[3 + d], x[d]);
      }
    }
  globalMax(comm, ends);
  double extent = 0.0;
  for (std::size_t d = 0; d < 3; ++d)
    extent = std::max(extent, ends[d] + ends[3 + d]);
  return extent;
}

// The normal equations AᵀAm = Aᵀu of the rigid motion m next to the displacement of a body, and uᵀu. A row of
// A is that of a dof: an axis, then (e × x) of each rotation.
class RigidFit {
 public:
  explicit RigidFit(int components)
      : components_(static_cast<std::size_t>(components)),
        modes_(components == 3   ? 6
               : components == 2 ? 3
                                 : 1),
        sums_(modes_ * modes_ + modes_ + 2, 0.0) {}

  std::vector<double>& sums() { return sums_; }

  void add(const fem::Point& x, const double* u) {
    for (std::size_t c = 0; c < components_; ++c) {
      std::vector<double> row(modes_, 0.0);
      row[c] = 1.0;
      if (components_ == 2)
        row[2] = c == 0 ? -x[1] : x[0];
      for (std::size_t e = 0; components_ == 3 && e < 3; ++e)
        if (e != c)
          row[3 + e] = (e + 1) % 3 == c ? -x[3 - e - c] : x[3 - e - c];
      for (std::size_t i = 0; i < modes_; ++i) {
        for (std::size_t j = 0; j < modes_; ++j)
          sums_[j * modes_ + i] += row[i] * row[j];
        sums_[modes_ * modes_ + i] += row[i] * u[c];
      }
      sums_[sums_.size() - 2] += u[c] * u[c];
    }
    sums_.back() += 1.0;
  }

  // What m leaves of u, a root mean square over the nodes.
  double deformation() const {
    const auto n = static_cast<std::ptrdiff_t>(modes_);
    const std::vector<double> matrix(sums_.begin(), sums_.begin() + n * n),
        rhs(sums_.begin() + n * n, sums_.begin() + n * n + n);
    const std::vector<double> m = PivotedCholesky(matrix, static_cast<int>(n)).solve(rhs);
    double left = sums_[sums_.size() - 2];
    for (std::size_t i = 0; i < modes_; ++i)
      left -= m[i] * rhs[i];
    return sums_.back() > 0.0 ? std::sqrt(std::max(left, 0.0) / sums_.back()) : 0.0;
  }

 private:
  std::size_t components_, modes_;
  std::vector<double> sums_;
};

// The largest deformation of a body. @note Collective.
double largestDeformation(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                          const std::vector<scene::OwnedSubdomain>& owned, const feti::TornVector& u) {
  const auto components = static_cast<std::size_t>(scene.components());
  std::vector<RigidFit> fits(scene.bodies.size(), RigidFit(scene.components()));
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (int node = 0; node < owned[i].mesh.mesh->numberOfNodes(); ++node)
      fits[static_cast<std::size_t>(owned[i].body)].add(
          owned[i].mesh.position(node), u[i].data() + static_cast<std::size_t>(node) * components);
  double largest = 0.0;
  for (RigidFit& fit : fits) {
    globalSum(comm, fit.sums());
    largest = std::max(largest, fit.deformation());
  }
  return largest;
}

} // namespace

std::string driftText(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                      const std::vector<scene::OwnedSubdomain>& owned, const feti::TornVector& u,
                      double prescribed) {
  std::vector<double> largest(scene.bodies.size(), 0.0);
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (const double value : u[i]) {
      double& ofBody = largest[static_cast<std::size_t>(owned[i].body)];
      ofBody = std::max(ofBody, std::abs(value));
    }
  globalMax(comm, largest);
  const double extent = extentOf(comm, owned), farthest = *std::max_element(largest.begin(), largest.end());
  constexpr double most = 10.0; // of what deforms or is prescribed, bodies that follow it may move
  if (!(farthest > extent) || farthest <= most * globalMax(comm, prescribed) ||
      farthest <= most * largestDeformation(comm, scene, owned, u))
    return "";
  std::string names;
  for (std::size_t b = 0; b < largest.size(); ++b)
    if (largest[b] > extent)
      names += (names.empty() ? "\"" : ", \"") + scene.bodies[b].name + "\"";
  return "drift: " + names + " moved by up to " + scientific(farthest) + " in a scene of size " +
         scientific(extent) +
         ", almost without deformation: only small differences between contact normals resist a rigid-body "
         "mode. Prescribe a displacement in that direction or add friction";
}

} // namespace Harmos::run
