#pragma once

#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <quiver/core/io/files/output_file.h>
#include <quiver/core/io/text/number_writer.h>

namespace quiver::app {

/// Lines of a .g2o file, passed on in pieces.
class WorldWriter {
 public:
  explicit WorldWriter(const std::string& path) : file_(path) {}

  void line(std::string_view tag, std::initializer_list<std::int64_t> ids, std::span<const double> values = {},
            std::span<const double> informationDiagonal = {}) {
    out_.text(tag);
    for (const std::int64_t id : ids) {
      out_.character(' ');
      out_.integer(id);
    }
    for (const double value : values) number(value);
    for (std::size_t row = 0; row < informationDiagonal.size(); ++row) {
      for (std::size_t column = row; column < informationDiagonal.size(); ++column)
        number(row == column ? informationDiagonal[row] : 0.0);
    }
    out_.character('\n');
    if (out_.size() > pieceBytes) flush();
  }
  void commit() {
    flush();
    file_.commit();
  }

 private:
  static constexpr std::size_t pieceBytes = 1 << 20;
  void number(double value) {
    out_.character(' ');
    out_.real(value);
  }
  void flush() {
    file_.write(out_.view());
    out_.clear();
  }
  OutputFile file_;
  NumberWriter out_;
};

}  // namespace quiver::app
