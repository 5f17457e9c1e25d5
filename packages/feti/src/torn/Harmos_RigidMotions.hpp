// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SubdomainSystem.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::feti {

/// R as the coarse problem has it: R = diag(R_i) T, R_i the kernels of this rank's subdomains.
///
/// Without clusters T = I, and each subdomain has motions of its own. With clusters each of these has the
/// motions that leave it whole, and T says how its subdomains move in them.
///
/// A vector of motions has a number for each column of R of this rank, in the order of ownColumns().
/// Amplitudes are those of the columns of all R_i, one subdomain after the other.
class RigidMotions {
 public:
  /// Subdomains of this rank that move together.
  struct Part {
    std::vector<int> members; ///< subdomains of this rank, by rising numbers
    int columns = 0;
    /// Rows of T of each member, column after column; its kernel has as many columns as T rows there.
    std::vector<std::vector<double>> coefficients;
  };

  /// Each subdomain by itself. @param system to outlive this. Not explicit: a system has its motions.
  RigidMotions(const SubdomainSystem& system);
  /// @param parts each subdomain of this rank is in one of them.
  /// @param bases for each subdomain the one whose kernel, of the same space, stands for its own.
  /// @note Collective.
  RigidMotions(const SubdomainSystem& system, std::vector<Part> parts, std::vector<int> bases);

  const SubdomainSystem& system() const { return *system_; }
  /// Columns of R over all ranks.
  int dimension() const { return dimension_; }
  /// Whether each subdomain moves by itself.
  bool areOfSubdomains() const { return parts_.empty(); }
  /// Over all ranks.
  long long totalParts() const { return totalParts_; }
  /// Of this rank.
  int parts() const { return areOfSubdomains() ? system_->size() : static_cast<int>(parts_.size()); }
  /// Of a part, its subdomains.
  std::vector<int> members(int part) const;
  /// R_i.
  const Kernel& kernel(int subdomain) const {
    return system_->kernel(bases_.empty() ? subdomain : bases_[static_cast<std::size_t>(subdomain)]);
  }
  /// By rising parts; numbers do not depend on ranks but by the parts that there are.
  const std::vector<int>& ownColumns() const { return ownColumns_; }
  /// Of each part the place of its first column among them, and the end.
  const std::vector<std::size_t>& places() const { return places_; }

  /// sᵀT_i for a number for each column of R_i: a number for each column of the part. @param absolute with
  /// |T|, for bounds.
  std::vector<double> ofPart(int part, std::size_t member, const double* s, bool absolute = false) const;

  /// Tα: amplitudes of a vector of motions. Local.
  std::vector<double> amplitudes(const std::vector<double>& motions) const;
  /// Tᵀe of numbers for amplitudes. @param absolute with |T|. Local.
  std::vector<double> motions(const std::vector<double>& amplitudes, bool absolute = false) const;
  /// Place of the first amplitude of each subdomain, and the end.
  const std::vector<std::size_t>& amplitudePlaces() const { return amplitudePlaces_; }

 private:
  void countAmplitudes();

  const SubdomainSystem* system_;
  std::vector<Part> parts_; ///< none: T = I
  std::vector<int> bases_;
  int dimension_ = 0;
  long long totalParts_ = 0;
  std::vector<int> ownColumns_;
  std::vector<std::size_t> places_ = {0}, amplitudePlaces_ = {0};
};

} // namespace Harmos::feti
