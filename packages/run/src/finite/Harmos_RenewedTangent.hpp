// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeformedBodies.hpp"
#include "Harmos_TornArchive.hpp"

#include <optional>
#include <vector>

namespace Harmos::run {

/// The tangent of Newton's iterations: that of each subdomain is as at rest until it is made anew, and turns
/// with the body from there. Subdomains that yield have theirs made anew in each iteration, no other does but
/// where it has become wrong.
///
/// Guarded by tests/verification/finite and tests/verification/physics/test_plasticity.py.
class RenewedTangent {
 public:
  /// @param bodies to outlive it. @param tangent, displacement at rest.
  RenewedTangent(const DeformedBodies& bodies, DeformedBodies::Tangent tangent,
                 const feti::TornVector& displacement);

  /// For an iteration. @param isWrong of all of them. @note Collective.
  void renew(const feti::TornVector& displacement, double time, const std::vector<char>& yields,
             bool isWrong);
  /// A step begins from there, maybe again: states of materials are others. @note Collective.
  void begin(const feti::TornVector& displacement, double time);
  /// All of them. @note Collective.
  void reset(const feti::TornVector& displacement, double time);
  /// These yield in the answer of a step: begin() makes theirs anew.
  void noteYielding(const std::vector<char>& yields);

  const DeformedBodies::Tangent& tangent() const { return tangent_; }
  /// By how subdomains have turned since theirs was made. Local.
  std::vector<std::optional<feti::Frame>> frames(const feti::TornVector& displacement) const;
  /// For checkpoints: which ones there are; reading, they are made. @note Collective.
  void exchange(TornArchive& torn, bool isReading);

 private:
  void make(const feti::TornVector& displacement, double time, const std::vector<char>& which);

  const DeformedBodies& bodies_;
  DeformedBodies::Tangent tangent_;
  feti::TornVector displacement_;
  // Of each subdomain: whether it is not as at rest, and goes on yielding; of which temperatures.
  std::vector<char> isMade_, yields_;
  std::vector<double> times_;
};

} // namespace Harmos::run
