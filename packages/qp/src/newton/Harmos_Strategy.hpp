// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_NewtonState.hpp"

#include <string>

namespace Harmos::qp {

/// What goes wrong with faces.
enum class Trouble {
  NoFace,     ///< a face cannot be entered: the equalities cannot be met there
  BadFace,    ///< its equations are singular, or break down
  NoProgress, ///< faces come back, or do not get on
  ManyFaces   ///< there were too many
};

/// A way to get on where the semismooth Newton method alone does not. Globalization has the order in which
/// they are tried; the hooks after propose() are asked whether it was tried or not.
template<class Scalar, class MV, class OP>
class Strategy {
 public:
  using State = NewtonState<Scalar, MV, OP>;

  explicit Strategy(State& state) : s_(state) {}
  virtual ~Strategy() = default;

  /// Whether it may help.
  virtual bool isAgainst(Trouble trouble) const = 0;
  /// Changes iterate and face, or how faces are made from here on. @return whether it had something to
  /// propose; if not nothing has changed. @note Collective.
  virtual bool propose(const std::string& why) = 0;

  /// Whether it sees to progress itself, without a limit of faces.
  virtual bool seesToProgress() const { return false; }

  virtual void exchange(StateArchive<MV>& /*archive*/) {}

 protected:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;

  void log(const std::string& what) const { s_.log.detail("PDAS: " + what); }

  State& s_;
};

} // namespace Harmos::qp
