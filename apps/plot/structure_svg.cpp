#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <quiver/apps/plot/structure.h>

namespace quiver::app {
namespace {

constexpr double side = 512.0;
constexpr double margin = 24.0;
constexpr double headHeight = 72.0;
constexpr double footHeight = 48.0;
/// Shares of a cell are drawn in so many shades.
constexpr int shades = 5;

std::string escape(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else {
      result += c;
    }
  }
  return result;
}

/// 0 for an empty cell; the fuller, the darker.
int shadeOf(float share) {
  if (!(share > 0.0f)) return 0;
  return std::clamp(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(share)) * shades)), 1, shades);
}

/// Runs of equal cells as horizontal strokes, one path a shade, in units of cells.
std::string drawCells(const MatrixPicture& picture) {
  std::string svg;
  for (int shade = 1; shade <= shades; ++shade) {
    std::string path;
    for (int row = 0; row < picture.cells; ++row) {
      const float* shares = picture.shares.data() + static_cast<std::ptrdiff_t>(row) * picture.cells;
      for (int column = 0; column < picture.cells;) {
        int end = column;
        while (end < picture.cells && shadeOf(shares[end]) == shade) ++end;
        if (end > column) path += fmt::format("M{} {}.5h{}", column, row, end - column);
        column = std::max(end, column + 1);
      }
    }
    if (path.empty()) continue;
    const int grey = 205 - 41 * (shade - 1);
    svg += fmt::format("<path d=\"{}\" stroke=\"rgb({},{},{})\"/>\n", path, grey * 2 / 5, grey * 3 / 5, grey);
  }
  return svg;
}

std::string drawMatrix(const MatrixPicture& picture, double left) {
  std::string svg = fmt::format(
      "<text x=\"{:.0f}\" y=\"{:.0f}\" class=\"title\">{}</text>\n"
      "<text x=\"{:.0f}\" y=\"{:.0f}\">{} blocks, {} unknowns a side</text>\n",
      left, headHeight - 30.0, escape(picture.title), left, headHeight - 12.0, picture.blocks, picture.scalars);
  svg +=
      fmt::format("<g transform=\"translate({:.0f} {:.0f}) scale({:.6g})\" fill=\"none\" stroke-width=\"1\">\n{}</g>\n",
                  left, headHeight, side / picture.cells, drawCells(picture));
  svg += fmt::format("<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" class=\"frame\"/>\n", left,
                     headHeight, side, side);
  svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\">{} blocks stored, {} numbers, {:.3g} % full</text>\n", left,
                     headHeight + side + 20.0, picture.storedBlocks, picture.storedScalars, 100.0 * picture.fill);
  return svg;
}

}  // namespace

std::string drawStructure(const StructurePictures& pictures) {
  const double width = margin + static_cast<double>(pictures.matrices.size()) * (side + margin);
  const double height = headHeight + side + footHeight;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n"
      "<style>text{{font:13px sans-serif;fill:#333}}.title{{font-weight:bold;font-size:15px}}"
      ".frame{{fill:none;stroke:#888}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width, height);
  svg += fmt::format("<text x=\"{:.0f}\" y=\"20\">{}</text>\n", margin, escape(pictures.elimination));
  for (std::size_t i = 0; i < pictures.matrices.size(); ++i)
    svg += drawMatrix(pictures.matrices[i], margin + static_cast<double>(i) * (side + margin));
  return svg + "</svg>\n";
}

}  // namespace quiver::app
