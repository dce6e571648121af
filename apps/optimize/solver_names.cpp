#include <quiver/apps/optimize/solver_names.h>

namespace quiver::app {
namespace {

constexpr SolverName names[] = {
    {"gn_var", "gn", "block"},
    {"gn_fix3_2", "gn", "block"},
    {"gn_fix6_3", "gn", "block"},
    {"gn_fix7_3", "gn", "block"},
    {"lm_var", "lm", "block"},
    {"lm_fix3_2", "lm", "block"},
    {"lm_fix6_3", "lm", "block"},
    {"lm_fix7_3", "lm", "block"},
    {"dl_var", "dogleg", "block"},
    {"gn_var_cholmod", "gn", "cholmod"},
    {"gn_fix3_2_cholmod", "gn", "cholmod"},
    {"gn_fix6_3_cholmod", "gn", "cholmod"},
    {"gn_fix7_3_cholmod", "gn", "cholmod"},
    {"lm_var_cholmod", "lm", "cholmod"},
    {"lm_fix3_2_cholmod", "lm", "cholmod"},
    {"lm_fix6_3_cholmod", "lm", "cholmod"},
    {"lm_fix7_3_cholmod", "lm", "cholmod"},
    {"dl_var_cholmod", "dogleg", "cholmod"},
    {"gn_var_csparse", "gn", "block"},
    {"gn_fix3_2_csparse", "gn", "block"},
    {"gn_fix6_3_csparse", "gn", "block"},
    {"gn_fix7_3_csparse", "gn", "block"},
    {"lm_var_csparse", "lm", "block"},
    {"lm_fix3_2_csparse", "lm", "block"},
    {"lm_fix6_3_csparse", "lm", "block"},
    {"lm_fix7_3_csparse", "lm", "block"},
    {"dl_var_csparse", "dogleg", "block"},
    {"gn_dense", "gn", "dense"},
    {"gn_dense3_2", "gn", "dense"},
    {"gn_dense6_3", "gn", "dense"},
    {"gn_dense7_3", "gn", "dense"},
    {"lm_dense", "lm", "dense"},
    {"lm_dense3_2", "lm", "dense"},
    {"lm_dense6_3", "lm", "dense"},
    {"lm_dense7_3", "lm", "dense"},
    {"gn_pcg", "gn", "pcg"},
    {"gn_pcg3_2", "gn", "pcg"},
    {"gn_pcg6_3", "gn", "pcg"},
    {"gn_pcg7_3", "gn", "pcg"},
    {"lm_pcg", "lm", "pcg"},
    {"lm_pcg3_2", "lm", "pcg"},
    {"lm_pcg6_3", "lm", "pcg"},
    {"lm_pcg7_3", "lm", "pcg"},
    {"2dlinear", "gn", "block", "chordal"},
    {"structure_only_2", "lm", "block", "file", 2},
    {"structure_only_3", "lm", "block", "file", 3},
};

}  // namespace

std::span<const SolverName> solverNames() { return names; }

const SolverName* findSolverName(std::string_view name) {
  for (const SolverName& entry : names) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

}  // namespace quiver::app
