// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FeasibleSet.hpp"
#include "Harmos_NonsmoothBlock.hpp"

namespace Harmos::qp {

/// Pairs within discs: ψ is zero within |y| ≤ r, y = x − c, infinite outside.
///
/// A pair slips where z = y − tg lies outside, along the tangent at n = z/|z| and with κ = (|z| − r)/(tr):
/// Newton's method for x = Π(x − tg), symmetric since the radius is given (Alart, Curnier, Comput. Methods
/// Appl. Mech. Engrg. 92, 1991). Within discs of no radius it is held.
///
/// Guarded by tests/unit/qp/test_blocks.cpp and test_discs.cpp.
class Discs : public NonsmoothBlock {
 public:
  /// @param discs to be kept by whoever made them; null: none.
  explicit Discs(const LocalDiscs* discs) : discs_(discs) {}

  Kind kind() const override { return {true, false, true}; }
  void mark(char* entries) const override;
  void project(double* x) const override;
  void project(const double* x, double* g) const override;
  void update(const double* x, const double* g, const FaceUpdate& how, const ActiveFace& before,
              ActiveFace& face, FaceTally& tally) const override;
  /// To rims along the radius; to tangents.
  void moveToFace(const ActiveFace& face, double* x) const override;
  double recede(double* d) const override;

 private:
  const std::vector<Disc>& discs() const;

  const LocalDiscs* discs_;
};

} // namespace Harmos::qp
