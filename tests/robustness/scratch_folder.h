#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace quiver::test {

/// A folder of its own for a test, removed at its end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "quiver-robustness-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~ScratchFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A ring of n poses in the plane as a .g2o text, its numbers depending on `shift`.
inline std::string ringText(int poses, double shift) {
  std::ostringstream text;
  text.precision(17);
  for (int i = 0; i < poses; ++i)
    text << "VERTEX_SE2 " << i << ' ' << 0.3 * i + shift << ' ' << 0.7 * shift << " 0.1\n";
  for (int i = 0; i < poses; ++i)
    text << "EDGE_SE2 " << i << ' ' << (i + 1) % poses << " 0.3 0.01 " << 6.283 / poses << " 100 0 0 100 0 400\n";
  return text.str();
}

}  // namespace quiver::test
