// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundViews.hpp"
#include "Harmos_FollowingLimits.hpp"

#include <Teuchos_RCP.hpp>

#include <algorithm>
#include <memory>

namespace Harmos::qp {

/// Limits that follow the solution, of intervals and discs that are blocks themselves: what those say of a
/// face holds but for what an entry does at a limit that moves. An entry that is pushed against its limit
/// stays there, wherever that has gone; else it is held where x − tg is beyond.
///
/// Guarded by tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV>
class CoulombLimits : public NonsmoothBlock {
 public:
  /// @param lower, upper, discs what the limits are those of, and change with them; upper null without
  /// intervals, discs null without discs.
  CoulombLimits(std::shared_ptr<const FollowingLimits> limits, Teuchos::RCP<MV> lower, Teuchos::RCP<MV> upper,
                std::shared_ptr<LocalDiscs> discs)
      : limits_(std::move(limits)),
        lower_(std::move(lower)),
        upper_(std::move(upper)),
        discs_(std::move(discs)) {}

  Kind kind() const override { return {true, true, false}; }
  void mark(char* /*entries*/) const override {}
  void project(double* /*x*/) const override {}
  void project(const double* /*x*/, double* /*g*/) const override {}
  double recede(double* /*d*/) const override { return 0.0; }

  void update(const double* x, const double* g, const FaceUpdate& how, const ActiveFace& before,
              ActiveFace& face, FaceTally& tally) const override {
    Kernels::update(*limits_, x, g, BT::read(*lower_), upper(), discs_.get(), how, before, face, tally);
  }
  /// Without what other blocks have moved to limits that were there before.
  void moveToFace(const ActiveFace& face, double* x) const override {
    Kernels::moveToFollowing(face.couplings, BT::read(*lower_), x);
  }

  void follow(const double* x, const double* g, const FollowUpdate& how) override {
    Kernels::follow(*limits_, x, g, how, BT::write(*lower_), upper_.is_null() ? nullptr : BT::write(*upper_),
                    discs_.get());
  }
  void release(ActiveFace& face) const override { Kernels::leaveOut(*limits_, discs_.get(), face); }
  void couple(ActiveFace& face) const override {
    face.couplings = Kernels::couplings(*limits_, discs_.get(), face);
  }
  void moveToLimits(const ActiveFace& face, double* x) const override {
    Kernels::moveToLimits(*limits_, BT::read(*lower_), upper(), discs_.get(), face, x);
  }
  void putLimits(double* limits) const override {
    Kernels::limitsToArray(*limits_, upper(), discs_.get(), limits);
  }
  void takeLimits(const double* limits) override {
    Kernels::arrayToLimits(*limits_, limits, BT::write(*lower_),
                           upper_.is_null() ? nullptr : BT::write(*upper_), discs_.get());
  }

 private:
  using BT = BoundTraits<Scalar, MV>;
  const double* upper() const { return upper_.is_null() ? nullptr : BT::read(*upper_); }

  std::shared_ptr<const FollowingLimits> limits_;
  Teuchos::RCP<MV> lower_, upper_;
  std::shared_ptr<LocalDiscs> discs_;
};

} // namespace Harmos::qp
