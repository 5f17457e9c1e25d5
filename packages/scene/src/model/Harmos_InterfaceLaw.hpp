// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstring>
#include <functional>
#include <optional>
#include <type_traits>
#include <vector>

namespace Harmos::contact {
struct ContactPoint;
}

namespace Harmos::scene {

/// What a law keeps of the points of an interface: a plain struct of doubles of each, zero before the first
/// step. Of the points of one rank, which has their rows, too.
class PointStates {
 public:
  PointStates() = default;
  /// @param size of a state, in doubles.
  PointStates(std::size_t points, std::size_t size) : size_(size), numbers_(points * size, 0.0) {}
  template<class State>
  static PointStates of(std::size_t points) {
    return {points, sizeOf<State>()};
  }
  /// Of a state, in doubles.
  template<class State>
  static constexpr std::size_t sizeOf() {
    static_assert(std::is_trivially_copyable_v<State> && sizeof(State) % sizeof(double) == 0);
    return sizeof(State) / sizeof(double);
  }

  std::size_t points() const { return size_ == 0 ? 0 : numbers_.size() / size_; }
  template<class State>
  State get(std::size_t point) const {
    State state;
    std::memcpy(&state, numbers_.data() + point * sizeOf<State>(), sizeof state);
    return state;
  }
  template<class State>
  void set(std::size_t point, const State& state) {
    std::memcpy(numbers_.data() + point * sizeOf<State>(), &state, sizeof state);
  }

  /// All of them, a point after the other.
  std::vector<double>& numbers() { return numbers_; }

 private:
  std::size_t size_ = 0;
  std::vector<double> numbers_;
};

/// The law of an interface: what holds the rows of its points, from their state. A run holds states in two
/// copies: what was committed with the last step that was accepted, and the trial state of the step that is
/// being solved, which starts from that. A step that fails, is halved or taken up again from a checkpoint
/// starts from the committed one, whatever happened to the trial.
///
/// Friction and Adhesion are two. Points and rows are those of one rank; members are local unless they say
/// otherwise. Guarded by tests/unit/run/test_step_sequence.cpp and tests/unit/effects/test_adhesion.cpp.
class InterfaceLaw {
 public:
  /// An inequality row of a point, or one of the limited rows of its friction or adhesion: those of a point
  /// in their order, after all inequality rows.
  struct Row {
    const contact::ContactPoint* point;
    std::size_t place = 0; ///< of its point, among those of the states
    bool isLimited = false;
  };
  /// The same in an answer.
  struct RowAnswer : Row {
    double gap = 0.0;               ///< that is left to the bound, as the state has shifted it
    double force = 0.0;             ///< multiplier
    std::optional<double> softness; ///< with which it was found
    double unstretched = 0.0;       ///< see Spring

    /// How far it is open, below zero where springs on the way to an answer let surfaces pass, or has
    /// slipped.
    double opening() const;
    /// The force against that; nothing of limited rows that no spring holds.
    double hold() const;
  };
  /// What holds a row: ConstraintRow::softness, and by how much Bu is beyond the bound that the row was made
  /// with where it has no force. Of a limited row whose spring broke in this step: at which slip, from where
  /// friction takes over.
  struct Spring {
    std::optional<double> softness;
    double unstretched = 0.0;
    std::optional<double> brokenAt = std::nullopt;
  };

  virtual ~InterfaceLaw() = default;

  /// Doubles of a point's state, see PointStates.
  virtual std::size_t stateSize() const = 0;
  /// A step begins, for the first time or again, from what was committed.
  virtual void beginStep(PointStates& /*trial*/) const {}
  /// What the state adds to the bounds of these rows.
  virtual void addToBounds(const PointStates& /*state*/, const std::vector<Row>& /*rows*/,
                           std::vector<double>& /*bounds*/) const {}
  /// What the state makes of the springs of these rows, of which some may have none.
  /// @param springs as the rows were made; no softness: a contact, or friction.
  virtual void soften(const PointStates& /*state*/, const std::vector<Row>& /*rows*/,
                      std::vector<Spring>& /*springs*/) const {}
  /// The largest of the ranks' numbers. @note Collective.
  using Largest = std::function<double(double)>;
  /// Brings the trial state up to an answer that has converged; whether the step is to be solved again with
  /// it, on any rank. A step whose state does not settle has failed. @param tolerance of the answer.
  /// @note Collective, where it asks for the largest of a number.
  virtual bool updateState(const std::vector<RowAnswer>& /*answer*/, double /*tolerance*/,
                           const Largest& /*largest*/, PointStates& /*trial*/) const {
    return false;
  }

  // Of laws whose points soften, so that no convex problem has their answer: the run looks for openings at
  // which bodies and laws agree, those of all such laws together, with the springs of soften(). See
  // run::Softening.

  virtual bool softens() const { return false; }
  /// The forces by which the law holds rows that are open so far, from the state with which the step began.
  virtual std::vector<double> lawForces(const PointStates& /*trial*/, const std::vector<Row>& /*rows*/,
                                        const std::vector<double>& /*openings*/) const {
    return {};
  }
  /// How far forces of an answer are from the law's, at the worst point: a share of its strength.
  virtual double misfit(const std::vector<RowAnswer>& /*answer*/, const PointStates& /*trial*/) const {
    return 0.0;
  }
  /// The damage of such openings, and springs: with it, through the origin; or where points soften through
  /// force and opening, so many times as stiff as softening is steep.
  /// @param known to what tractions are, as a share of the strength.
  /// @return whether any of them softens.
  virtual bool follow(const std::vector<Row>& /*rows*/, const std::vector<double>& /*openings*/,
                      std::optional<double> /*steepness*/, double /*known*/, PointStates& /*trial*/) const {
    return false;
  }

  // Of laws whose points break.

  /// Whether they do: even a static state is a step then, for its first solution need not be its last.
  virtual bool breaks() const { return false; }
  /// Of a point, from 0 to 1.
  virtual double damage(const PointStates& /*state*/, std::size_t /*point*/) const { return 0.0; }
  /// What damage has dissipated since the beginning of the run; area by area, how much of an interface has
  /// broken since the step began, and how much there is.
  struct Broken {
    double dissipated = 0.0, share = 0.0, area = 0.0;
  };
  virtual Broken broken(const PointStates& /*state*/, const std::vector<Row>& /*rows*/) const { return {}; }
  /// The share of an interface that may break in one step: beyond it the step is halved, as long as it may
  /// be.
  virtual double mostBroken() const { return 1.0; }
};

} // namespace Harmos::scene
