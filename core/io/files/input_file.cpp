#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <quiver/core/io/files/inflate.h>
#include <quiver/core/io/files/input_file.h>
#include <quiver/core/util/error.h>

namespace quiver {
namespace {

[[noreturn]] void failReading(const std::string& name, int error) {
  throw FileError(fmt::format("{}: cannot be read: {}", name, std::strerror(error)));
}

class Descriptor {
 public:
  explicit Descriptor(int value, bool owned) : value_(value), owned_(owned) {}
  ~Descriptor() {
    if (owned_) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }

 private:
  int value_;
  bool owned_;
};

/// Half of the machine's memory: the graph of a text takes about as much as the text.
std::size_t usefulMemory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long pageSize = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && pageSize > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(pageSize) / 2
                                   : std::size_t{1} << 40;
}

}  // namespace

InputFile::InputFile(const std::string& path, std::int64_t maxBytes) : name_(path == "-" ? "<stdin>" : path) {
  try {
    load(path);
    storedBytes_ = static_cast<std::int64_t>(size_);
    inflateIfCompressed(maxBytes);
  } catch (const std::bad_alloc&) {
    release();
    throw FileError(fmt::format("{}: does not fit into memory", name_));
  } catch (...) {
    release();
    throw;
  }
}

InputFile::~InputFile() { release(); }

InputFile::InputFile(InputFile&& other) noexcept
    : name_(std::move(other.name_)),
      data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      storedBytes_(other.storedBytes_),
      mapped_(std::exchange(other.mapped_, false)) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  if (this != &other) {
    release();
    name_ = std::move(other.name_);
    data_ = std::exchange(other.data_, nullptr);
    size_ = std::exchange(other.size_, 0);
    storedBytes_ = other.storedBytes_;
    mapped_ = std::exchange(other.mapped_, false);
  }
  return *this;
}

void InputFile::load(const std::string& path) {
  if (path.empty()) throw FileError("the path of the file to read is empty");
  if (path == "-") return readAll(STDIN_FILENO);
  // Characters that a C string cannot hold would open another file.
  if (path.find('\0') != std::string::npos) throw FileError("a path cannot hold a NUL character");
  const int opened = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (opened < 0 && errno == ENOENT) throw FileError(fmt::format("{}: no such file", name_));
  if (opened < 0) failReading(name_, errno);
  const Descriptor descriptor(opened, true);
  struct stat status;
  if (::fstat(opened, &status) != 0) failReading(name_, errno);
  if (S_ISDIR(status.st_mode)) throw FileError(fmt::format("{}: is a directory, not a file", name_));
  if (S_ISREG(status.st_mode) && status.st_size > 0) {
    map(opened, static_cast<std::size_t>(status.st_size));
  } else {
    readAll(opened);  // pipes, devices, and files of a size that only reading tells
  }
}

void InputFile::map(int descriptor, std::size_t size) {
  int flags = MAP_PRIVATE;
#ifdef MAP_POPULATE
  flags |= MAP_POPULATE;
#endif
  void* memory = ::mmap(nullptr, size, PROT_READ, flags, descriptor, 0);
  if (memory == MAP_FAILED) return readAll(descriptor);
  data_ = static_cast<const char*>(memory);
  size_ = size;
  mapped_ = true;
}

void InputFile::readAll(int descriptor) {
  detail::ByteBuffer buffer;
  const std::size_t limit = usefulMemory();
  for (;;) {
    if (buffer.size() > limit) throw FileError(fmt::format("{}: does not fit into memory", name_));
    buffer.makeRoom(std::size_t{1} << 16);
    const ssize_t got = ::read(descriptor, buffer.data() + buffer.size(), buffer.capacity() - buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) failReading(name_, errno);
    if (got == 0) break;
    buffer.append(static_cast<std::size_t>(got));
    if (*buffer.data() == '\0') break;  // no text in any format; and devices of zeros have no end
  }
  size_ = buffer.size();
  data_ = buffer.take();
}

void InputFile::inflateIfCompressed(std::int64_t maxBytes) {
  const detail::Compression compression = detail::detectCompression(text());
  if (compression == detail::Compression::none) return;
  detail::ByteBuffer inflated;
  const std::size_t limit = maxBytes > 0 ? static_cast<std::size_t>(maxBytes) : usefulMemory();
  detail::inflateAll(compression, text(), name_, limit, inflated);
  release();
  size_ = inflated.size();
  data_ = inflated.take();
}

void InputFile::release() {
  if (mapped_) {
    ::munmap(const_cast<char*>(data_), size_);
  } else {
    std::free(const_cast<char*>(data_));
  }
  data_ = nullptr;
  size_ = 0;
  mapped_ = false;
}

}  // namespace quiver
