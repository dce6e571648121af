#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/problem/problem.h>
#include <quiver/core/util/aligned_buffer.h>
#include <quiver/solvers/assembly/lane_products.h>

namespace quiver {

/// The linear system of a problem with one variable, say the pose of one camera among known points: no pattern, no
/// order, no assembly. Products are summed in lanes while edges are linearised, and the sum is factored in place.
///
/// A trial is linearised at once, so an accepted step costs one pass over the edges. Same bits for any number of
/// threads.
class SingleVariable final : public LinearSystem {
 public:
  /// Whether the problem has one variable, all of whose directions are free.
  static bool serves(const Problem& problem);

  void analyze(const Problem& problem, const Options& options, int threads) override;
  CostTotals linearize(const State& state) override;
  std::optional<CostTotals> tryState(const State& trial) override;
  void dropTrial() override { tried_ = nullptr; }
  LinearOutcome solve(std::span<const double> damping, std::span<double> delta, const StopCondition& stop) override;
  LinearOutcome solveWithLastFactor(std::span<double> delta, const StopCondition& stop) override;
  bool applyInverse(std::span<double> b) override;
  std::span<const double> gradient() const override { return current_.gradient; }
  std::span<const double> diagonal() const override { return current_.diagonal; }
  void multiply(std::span<const double> x, std::span<double> y) const override;
  const SolvePlan& plan() const override { return plan_; }
  void addSeconds(PhaseSeconds& seconds) override;

 private:
  /// H, row by row in full, g and the diagonal of H at one state.
  struct Equations {
    std::vector<double> matrix;
    std::vector<double> gradient;
    std::vector<double> diagonal;
    CostTotals totals;
  };
  /// Edges of one batch that are summed together.
  struct Piece {
    int batch;
    int begin;
    int end;
    CostTotals totals;
  };
  /// A batch: the role that all its edges give the variable, −1 if they differ, and the sum kernel of that role.
  struct Role {
    int common = -1;
    LaneProducts::Sum sum = nullptr;
  };
  struct Workspace {
    std::vector<PanelBuffer> panels;
    std::vector<std::int32_t> ids;
  };

  void compute(const State& state, Equations& equations);
  void sumPiece(const State& state, Piece& piece, double* sums, Workspace& work) const;
  void sumPanel(const Piece& piece, int first, int count, const EdgeShape& shape, const Panel& panel,
                double* sums) const;
  int roleOf(int batch, int edge) const;
  bool factorize(std::span<const double> damping, LinearOutcome& outcome);
  void substitute(std::span<double> b) const;

  const Problem* problem_ = nullptr;
  int dimension_ = 0;
  int threads_ = 1;
  InstructionSet set_ = InstructionSet::generic;
  std::vector<Role> roles_;
  std::vector<EdgeShape> shapes_;
  std::vector<Piece> pieces_;
  std::vector<Workspace> workspaces_;
  /// Of every piece: numbers of JᵀJ and Jᵀr in lanes.
  AlignedBuffer sums_;
  Equations current_;
  Equations trial_;
  /// Where `trial_` was computed, or null.
  const double* tried_ = nullptr;
  /// The lower triangle of the factor, row by row in full.
  std::vector<double> factor_;
  bool factored_ = false;
  SolvePlan plan_;
  PhaseSeconds seconds_;
};

}  // namespace quiver
