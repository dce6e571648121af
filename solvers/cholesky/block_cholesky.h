#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include <quiver/core/util/aligned_buffer.h>
#include <quiver/solvers/backends/linear_solver.h>
#include <quiver/solvers/cholesky/factor_plan.h>
#include <quiver/solvers/cholesky/kernels/kernel_level.h>

namespace quiver::detail {

/// Block Cholesky H + diag(damping) = L Lᵀ: leaf subtrees stored block by block under multifrontal fronts.
///
/// A node of the tree reads its blocks of H and its children's update matrices (what their elimination subtracts from
/// the rows below them), eliminates its columns and leaves an update matrix of its own. Subtrees share no memory, so
/// they run side by side; every sum has a fixed order, so the factor has the same bits for any number of threads.
class BlockCholesky final : public LinearSolver {
 public:
  explicit BlockCholesky(KernelLevel level = KernelLevel::automatic);

  std::string name() const override { return "block"; }
  BlockOrdering order(const BlockPattern& pattern) const override { return chooseOrdering(pattern); }
  void analyze(std::shared_ptr<const BlockPattern> pattern, int threads) override;
  SolverStatus factorize(const BlockMatrix& matrix, std::span<const double> damping,
                         const StopCondition& stop = {}) override;
  SolverStatus solve(std::span<double> rightHandSides, int count = 1) override;
  SolverStatus factorizeAndSolve(const BlockMatrix& matrix, std::span<const double> damping,
                                 std::span<double> rightHandSide, const StopCondition& stop = {}) override;
  FactorStatistics statistics() const override;

  const FactorPlan& plan() const { return plan_; }
  /// Bytes that it would hold for a pattern and so many threads. Analyses the structure and throws it away.
  static std::int64_t predictBytes(const BlockPattern& pattern, int threads);

 private:
  struct Input {
    const double* values;
    const double* damping;  // null if there is none
    const StopCondition* stop;
    /// Substitute forward, in the first column of the workspace, as nodes are finished.
    bool substitutes;
  };
  /// A pivot that was not positive: its scalar in the factor's numbering, or −1.
  struct Failure {
    std::int64_t scalar = -1;
    double pivot = 0.0;
  };

  /// Doubles of the workspace of one right-hand side.
  static std::int64_t workspaceOf(const FactorPlan& plan, const BlockPattern& pattern);

  /// Who works on a node: threads to divide it among, where update matrices that only its task needs are, and what the
  /// task will fill next.
  struct Worker {
    int threads;
    double* arena;
    UpcomingMemory& upcoming;
  };

  SolverStatus factorAll(const Input& input);
  Failure factorTask(std::int64_t task, const Input& input, double* arena, std::atomic<bool>& stopped);
  Failure factorNode(int node, const Input& input, const Worker& worker);
  Failure factorLeaf(int node, const Input& input, const Worker& worker);
  Failure factorFront(int node, const Input& input, const Worker& worker);
  double* updateOf(int node, const Worker& worker) {
    return (plan_.storage[node].sharedUpdate ? arena_.data() : worker.arena) + plan_.storage[node].update;
  }
  void loadColumns(int node, const Input& input, int firstBlock, int lastBlock);
  /// Adds the damping to the loaded diagonal blocks, whose columns are `stride` apart.
  void addDamping(int node, const Input& input, int firstBlock, int lastBlock, std::int64_t stride);
  void assemblePanel(int node, const Input& input, const Worker& worker, int firstBlock, int lastBlock);
  void formUpdate(int node, const Worker& worker, int strip);
  /// The first values of the node after this one, if it is before `end`.
  UpcomingMemory upcomingAfter(int node, int end);
  SolverStatus statusOf(const Failure& failure) const;

  /// One right-hand side on its way through the factor.
  struct Column {
    double* x;          // in the factor's numbering
    double* workspace;  // the nodes' parts of the substitution
  };
  Column columnOf(int index);
  void solveTogether(double* b, int count);
  /// Both directions for the columns 0 … count − 1, whose x is loaded.
  void forwardAll(int count);
  void backwardAll(int count);
  /// Copies between a vector in the pattern's order and one in the factor's.
  void loadVector(const double* b, double* x) const;
  void storeVector(const double* x, double* b) const;
  void forwardNode(int node, const Column& column);
  void backwardNode(int node, const Column& column);

  const KernelTable& kernels_;
  std::shared_ptr<const BlockPattern> pattern_;
  FactorPlan plan_;
  AlignedBuffer values_;           // the factor
  AlignedBuffer inverse_;          // reciprocals of its diagonal
  AlignedBuffer arena_;            // update matrices
  AlignedBuffer workspace_;        // of the right-hand sides that are solved together
  std::vector<Failure> failures_;  // of each task
  int threads_ = 0;                // of the analysis
  std::int64_t columnCount_ = 0;   // doubles of the workspace for one right-hand side
  bool factored_ = false;
};

}  // namespace quiver::detail
