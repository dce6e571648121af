#include "peers/blas.h"

#include <dlfcn.h>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver::bench {
namespace {

template <typename Function>
Function* find(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

std::string fileOf(void* symbol) {
  Dl_info info;
  return symbol != nullptr && dladdr(symbol, &info) != 0 && info.dli_fname != nullptr ? info.dli_fname : "";
}

}  // namespace

Blas singleThreadedBlas() {
  void* product = dlsym(RTLD_DEFAULT, "dgemm_");
  Blas blas{product == nullptr ? "none" : "reference BLAS", fileOf(product), false};
  if (const auto config = find<char*()>("openblas_get_config")) {
    blas.name = config();
    blas.optimized = true;
    find<void(int)>("openblas_set_num_threads")(1);
  } else if (const auto setThreads = find<void(int)>("MKL_Set_Num_Threads")) {
    blas.name = "MKL";
    blas.optimized = true;
    setThreads(1);
  } else if (const auto blisThreads = find<void(long)>("bli_thread_set_num_threads")) {
    blas.name = "BLIS";
    blas.optimized = true;
    blisThreads(1);
  } else if (dlsym(RTLD_DEFAULT, "ATL_dgemm") != nullptr || blas.file.find("atlas") != std::string::npos) {
    blas.name = "ATLAS";
  }
  return blas;
}

Blas demandBlas(bool anyBlas) {
  Blas blas = singleThreadedBlas();
  fmt::print("BLAS of the peers, one thread: {} ({})\n", blas.name, blas.file.empty() ? "file unknown" : blas.file);
  if (!blas.optimized && !anyBlas) {
    throw Error(
        fmt::format("the peers would run on {}, several times slower than they can: install OpenBLAS "
                    "(scripts/setup --bench) or pass --any-blas",
                    blas.name));
  }
  return blas;
}

}  // namespace quiver::bench
