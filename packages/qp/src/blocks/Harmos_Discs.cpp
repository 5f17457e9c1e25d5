// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Discs.hpp"

#include "Harmos_DiscGeometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_map>

namespace Harmos::qp {

using namespace DiscGeometry;

const std::vector<Disc>& Discs::discs() const {
  static const std::vector<Disc> none;
  return discs_ != nullptr ? discs_->discs() : none;
}

void Discs::mark(char* entries) const {
  for (const Disc& disc : discs())
    entries[disc.first] = entries[disc.second] = 1;
}

void Discs::project(double* x) const {
  for (const Disc& disc : discs())
    DiscGeometry::project(disc, x);
}

void Discs::project(const double* x, double* g) const {
  for (const Disc& disc : discs())
    if (const Pair y = fromCentre(disc, x); isOnRim(disc, y))
      set(disc, g, chopped(disc, y, of(disc, g)));
}

void Discs::update(const double* x, const double* g, const FaceUpdate& how, const ActiveFace& before,
                   ActiveFace& face, FaceTally& tally) const {
  std::unordered_map<int, const Slip*> slips;
  for (const Slip& slip : before.slipping)
    slips.emplace(slip.first, &slip);
  for (const Disc& disc : discs()) {
    const signed char was = face[static_cast<std::size_t>(disc.first)];
    const Slip* const last = was == ActiveFace::slips ? slips.at(disc.first) : nullptr;
    const Pair y = fromCentre(disc, x), gradient = of(disc, g);
    const double beyond = std::max(norm(y) - disc.radius, 0.0);
    const Pair z = {y.a - how.stepLength * gradient.a, y.b - how.stepLength * gradient.b};
    const double reach = norm(z);
    signed char state = 0;
    if (disc.radius <= touching(disc))
      state = ActiveFace::onRim;
    else if (reach > disc.radius + std::max(how.xNoise, touching(disc)))
      state = ActiveFace::slips;
    bool isChanged = state != was;
    tally.violation2 += beyond * beyond;
    if (state == ActiveFace::slips || last != nullptr) {
      const double wrong = norm(chopped(disc, y, gradient));
      tally.wrong2 += wrong * wrong;
      const double noise = std::max(how.gradientNoise, how.turn);
      const bool hasTurned = wrong > noise || (beyond > how.xNoise && beyond > how.stepLength * noise);
      isChanged = isChanged || hasTurned;
      if (state == ActiveFace::slips && last != nullptr && !hasTurned) {
        face.slipping.push_back(*last);
        face.slipping.back().radius = disc.radius; // which may follow the solution
      } else if (state == ActiveFace::slips)
        face.slipping.push_back(
            {disc.first,
             disc.second,
             {disc.centre[0], disc.centre[1]},
             disc.radius,
             {z.a / reach, z.b / reach},
             how.stepLength > 0.0 ? (reach - disc.radius) / (how.stepLength * disc.radius) : 0.0});
    }
    face[static_cast<std::size_t>(disc.first)] = face[static_cast<std::size_t>(disc.second)] = state;
    tally.turned += isChanged ? 1.0 : 0.0;
  }
}

void Discs::moveToFace(const ActiveFace& face, double* x) const {
  for (const Disc& disc : discs())
    if (const Pair y = fromCentre(disc, x); face[static_cast<std::size_t>(disc.first)] == ActiveFace::onRim &&
                                            norm(y) > 0.0 && std::abs(norm(y) - disc.radius) > touching(disc))
      put(disc, y, x);
  for (const Slip& slip : face.slipping) {
    const Pair n = {slip.normal[0], slip.normal[1]}, t = {-n.b, n.a};
    const Pair y = {x[slip.first] - slip.centre[0], x[slip.second] - slip.centre[1]};
    const double along = dot(t, y);
    // What is there already stays, to the last bit.
    const double rounding = 8.0 * std::numeric_limits<double>::epsilon() *
                            (norm(y) + std::abs(slip.centre[0]) + std::abs(slip.centre[1]));
    if (std::abs(dot(n, y) - slip.radius) <= rounding)
      continue;
    x[slip.first] = slip.centre[0] + slip.radius * n.a + along * t.a;
    x[slip.second] = slip.centre[1] + slip.radius * n.b + along * t.b;
  }
}

double Discs::recede(double* d) const {
  double removed2 = 0.0;
  for (const Disc& disc : discs()) {
    removed2 += dot(of(disc, d), of(disc, d));
    set(disc, d, {0.0, 0.0});
  }
  return removed2;
}

} // namespace Harmos::qp
