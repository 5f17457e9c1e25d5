// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Types.hpp"

#include <Tpetra_Operator.hpp>

namespace Harmos::feti {

/// An operator made from another one on the same space: what PFP and deflated operators have in common.
class EndomorphicOperator : public Operator {
 public:
  Teuchos::RCP<const Map> getDomainMap() const override { return inner_.getDomainMap(); }
  Teuchos::RCP<const Map> getRangeMap() const override { return inner_.getRangeMap(); }
  bool hasTransposeApply() const override { return true; }

 protected:
  /// To outlive this.
  explicit EndomorphicOperator(const Operator& inner) : inner_(inner) {}
  const Operator& inner() const { return inner_; }

 private:
  const Operator& inner_;
};

} // namespace Harmos::feti
