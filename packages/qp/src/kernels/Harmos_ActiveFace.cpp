// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ActiveFace.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace Harmos::qp::Kernels {

void maskHeld(const ActiveFace& face, double* v) {
  for (std::size_t i = 0; i < face.size(); ++i)
    if (face[i] != 0 && face[i] != ActiveFace::slips)
      v[i] = 0.0;
  for (const Slip& slip : face.slipping) {
    const double t[] = {-slip.normal[1], slip.normal[0]};
    const double along = t[0] * v[slip.first] + t[1] * v[slip.second];
    v[slip.first] = along * t[0];
    v[slip.second] = along * t[1];
  }
}

void addCurvature(const std::vector<Slip>& slipping, double f, const double* x, bool fromCentre, double* y) {
  for (const Slip& slip : slipping) {
    const double t[] = {-slip.normal[1], slip.normal[0]};
    double of[] = {x[slip.first], x[slip.second]};
    if (fromCentre)
      for (int k : {0, 1})
        of[k] -= slip.centre[k];
    const double along = f * slip.curvature * (t[0] * of[0] + t[1] * of[1]);
    y[slip.first] += along * t[0];
    y[slip.second] += along * t[1];
  }
}

void addSprings(const std::vector<Spring>& springs, double f, const double* x, bool fromCentre, double* y) {
  for (const Spring& spring : springs)
    y[spring.entry] += f * spring.curvature * (x[spring.entry] - (fromCentre ? spring.centre : 0.0));
}

void soften(const std::vector<Spring>& springs, double q, double least, double* v) {
  for (const Spring& spring : springs)
    v[spring.entry] *= std::max(least, q / (q + spring.curvature));
}

void addStiff(const std::vector<Spring>& springs, double q, const double* v, double* z) {
  for (const Spring& spring : springs)
    z[spring.entry] += spring.curvature / std::pow(q + spring.curvature, 2) * v[spring.entry];
}

void moveToSprings(const std::vector<Spring>& before, const std::vector<Spring>& springs, double q,
                   double* x) {
  SpringOf last(before);
  for (const Spring& spring : springs) {
    const Spring* const was = last(spring.entry);
    if (was != nullptr && was->centre == spring.centre)
      continue;
    double& entry = x[spring.entry];
    entry = spring.centre + q / (q + spring.curvature) * (entry - spring.centre);
  }
}

void addFollowing(const std::vector<Coupling>& couplings, const double* x, double* y) {
  for (const Coupling& coupling : couplings) {
    const double moved = coupling.factor * x[coupling.source];
    y[coupling.first] += moved * coupling.along[0];
    if (coupling.second >= 0)
      y[coupling.second] += moved * coupling.along[1];
  }
}

} // namespace Harmos::qp::Kernels
