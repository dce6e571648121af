#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <quiver/core/io/files/output_file.h>
#include <quiver/core/util/error.h>

namespace quiver {
namespace {

constexpr std::size_t bufferSize = std::size_t{1} << 18;

[[noreturn]] void failWriting(const std::string& name, const std::string& reason) {
  throw FileError(fmt::format("{}: cannot be written: {}", name, reason));
}

/// The file that `path` leads to, links followed; the last of them may lead to a file that does not exist.
std::string followLinks(const std::string& path, const std::string& name) {
  if (char* resolved = ::realpath(path.c_str(), nullptr)) {
    std::string result = resolved;
    std::free(resolved);
    return result;
  }
  std::filesystem::path current = path;
  constexpr int mostLinks = 40;
  for (int i = 0; i < mostLinks; ++i) {
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(current, error);
    if (error) return current.string();
    current = next.is_absolute() ? next : current.parent_path() / next;
  }
  failWriting(name, std::strerror(ELOOP));
}

struct Target {
  std::string path;
  /// Of the file that is there already.
  std::optional<struct stat> status;
  bool regular() const { return !status || S_ISREG(status->st_mode); }
};

Target findTarget(const std::string& path, const std::string& name) {
  if (path.empty()) throw FileError("the path of the file to write is empty");
  if (path.find('\0') != std::string::npos) throw FileError("a path cannot hold a NUL character");
  Target target{path, std::nullopt};
  struct stat status;
  if (::stat(path.c_str(), &status) == 0) {
    target.status = status;
    if (S_ISDIR(status.st_mode)) failWriting(name, "it is a directory");
    if (::access(path.c_str(), W_OK) != 0) failWriting(name, std::strerror(errno));
  } else if (errno != ENOENT) {
    failWriting(name, std::strerror(errno));
  } else if (path.back() == '/') {
    failWriting(name, "it names a directory that does not exist");
  }
  if (target.regular()) target.path = followLinks(path, name);
  return target;
}

/// Opens a new file beside `target`, with the mode that the target has or would get.
int openBeside(const Target& target, const std::string& name, std::string& temporary) {
  const std::filesystem::path folder = std::filesystem::path(target.path).parent_path();
  constexpr int mostAttempts = 10000;
  for (int attempt = 0; attempt < mostAttempts; ++attempt) {
    const std::string candidate = (folder / fmt::format(".quiver-{}-{}.tmp", ::getpid(), attempt)).string();
    const int descriptor = ::open(candidate.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      temporary = candidate;
      return descriptor;
    }
    const int error = errno;
    if (error == ENOENT && !std::filesystem::exists(folder))
      failWriting(name, fmt::format("there is no folder '{}'", folder.string()));
    if (error != EEXIST) failWriting(name, fmt::format("no temporary file in its folder: {}", std::strerror(error)));
  }
  failWriting(name, "its folder is full of temporary files");
}

void writeFully(int descriptor, std::string_view bytes, const std::string& name) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) failWriting(name, std::strerror(errno));
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

OutputFile::OutputFile(const std::string& path) : name_(path == "-" ? "<stdout>" : path) {
  if (path == "-") {
    descriptor_ = STDOUT_FILENO;
    return;
  }
  compressor_ = detail::makeCompressor(path);
  const Target target = findTarget(path, name_);
  ownsDescriptor_ = true;
  if (!target.regular()) {
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail(errno);
    return;
  }
  target_ = target.path;
  descriptor_ = openBeside(target, name_, temporary_);
  if (target.status) {
    // An owner that may not be kept is no failure; the mode is set last, since a change of owner may clear bits of it.
    [[maybe_unused]] const int ignored = ::fchown(descriptor_, target.status->st_uid, target.status->st_gid);
    ::fchmod(descriptor_, target.status->st_mode & 07777);
  }
}

OutputFile::~OutputFile() {
  if (ownsDescriptor_ && descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  if (committed_) throw LogicError(fmt::format("{}: written to after commit()", name_));
  if (buffer_.size() + bytes.size() > bufferSize) flush();
  if (bytes.size() < bufferSize) {
    buffer_.append(bytes);
  } else if (compressor_) {
    compressed_.clear();
    compressor_->compress(bytes, false, compressed_);
    writeFully(descriptor_, compressed_, name_);
  } else {
    writeFully(descriptor_, bytes, name_);
  }
}

void OutputFile::flush() {
  if (compressor_) {
    compressed_.clear();
    compressor_->compress(buffer_, committed_, compressed_);
    writeFully(descriptor_, compressed_, name_);
  } else {
    writeFully(descriptor_, buffer_, name_);
  }
  buffer_.clear();
}

void OutputFile::commit() {
  if (committed_) throw LogicError(fmt::format("{}: committed twice", name_));
  committed_ = true;
  flush();
  if (!ownsDescriptor_) return;
  if (!target_.empty() && ::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP) fail(errno);
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0 && errno != EINTR) fail(errno);
  if (target_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
}

void OutputFile::fail(int error) const { failWriting(name_, std::strerror(error)); }

void checkWritable(const std::string& path) {
  if (path == "-") {
    const int flags = ::fcntl(STDOUT_FILENO, F_GETFL);
    if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) failWriting("<stdout>", "standard output is closed");
    return;
  }
  const Target target = findTarget(path, path);
  if (!target.regular()) return;
  std::string temporary;
  ::close(openBeside(target, path, temporary));
  ::unlink(temporary.c_str());
}

}  // namespace quiver
