// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Qp.hpp"

#include <Tpetra_CrsMatrix_fwd.hpp>

#include <Teuchos_ParameterList.hpp>

#include <functional>

namespace Harmos {

using CrsMatrix = Tpetra::CrsMatrix<Scalar, LocalOrdinal, GlobalOrdinal, Node>;

/// −div(w grad v) = f with v given around a rectangle (0, X) × (0, Y), linear triangles on an n × n grid of
/// interior points, rows of points along x shared out among the ranks.
struct GridProblem {
  int n = 0;
  double lengthX = 0.0, lengthY = 0.0;
  Teuchos::RCP<const Map> map;
  Teuchos::RCP<CrsMatrix> matrix;
  Teuchos::RCP<MultiVector> rhs;
  std::function<double(double, double)> boundary; ///< empty: zero

  double hx() const { return lengthX / (n + 1); }
  double hy() const { return lengthY / (n + 1); }
};

/// @param weight w(x), constant over a triangle: the mean of its corners, as in MINPACK-2. @param load f(x,
/// y).
GridProblem gridProblem(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, int n, double lengthX,
                        double lengthY, const std::function<double(double)>& weight,
                        const std::function<double(double, double)>& load,
                        const std::function<double(double, double)>& boundary = {});

/// Values at the grid's points.
Teuchos::RCP<MultiVector> gridFunction(const GridProblem& grid,
                                       const std::function<double(double, double)>& value);

/// Bilinear interpolation of a coarser grid's vector and boundary values. @note Collective.
void interpolate(const GridProblem& coarse, const MultiVector& from, const GridProblem& fine,
                 MultiVector& to);

/// Smoothed aggregation multigrid (MueLu) of a matrix, with symmetric Gauss-Seidel.
Teuchos::RCP<Operator> multigrid(const Teuchos::RCP<CrsMatrix>& matrix);

/// An incomplete factorisation (Ifpack2, RILUK of fill level k) of a matrix, Schwarz between ranks.
Teuchos::RCP<Operator> incompleteFactor(const Teuchos::RCP<CrsMatrix>& matrix, int fill);

/// Multigrid for each face: couplings between free and active entries are dropped, the aggregates of the
/// whole matrix are kept. A face that differs from the last one made for in few entries gets that one's
/// multigrid.
class MultigridOnFace : public qp::TpetraFacePreconditioner {
 public:
  /// @param tolerance part of the entries that may have changed sides.
  MultigridOnFace(Teuchos::RCP<const CrsMatrix> matrix, double tolerance);
  Teuchos::RCP<const Operator> build(const MultiVector& free) override;
  double seconds() const { return seconds_; }

 private:
  Teuchos::RCP<const CrsMatrix> matrix_;
  double tolerance_;
  Teuchos::RCP<MultiVector> lastFree_;
  Teuchos::RCP<CrsMatrix> face_;
  Teuchos::RCP<Operator> hierarchy_;
  double seconds_ = 0.0;
};

} // namespace Harmos
