#include <cstdio>

#include <Eigen/Core>
#include <quiver/version.h>

int main() {
  std::printf("quiver %s\n", QUIVER_VERSION);
  return 0;
}
