#include <quiver/apps/plot/svg_plot.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>

namespace quiver::app {
namespace {

constexpr double panelSize = 640.0;
constexpr double margin = 24.0;
constexpr double headHeight = 56.0;
constexpr double footHeight = 84.0;
constexpr int shades = 24;

/// From a fit (blue) over doubt (yellow) to contradiction (red), readable for most colour-blind people.
std::string shadeColour(double position) {
  struct Stop {
    double at, red, green, blue;
  };
  static constexpr std::array<Stop, 5> stops{
      {{0.0, 49, 104, 178}, {0.3, 86, 180, 199}, {0.55, 240, 205, 90}, {0.8, 226, 106, 52}, {1.0, 158, 14, 44}}};
  const double p = std::clamp(position, 0.0, 1.0);
  std::size_t i = 1;
  while (i + 1 < stops.size() && p > stops[i].at) ++i;
  const Stop& a = stops[i - 1];
  const Stop& b = stops[i];
  const double t = (p - a.at) / (b.at - a.at);
  const auto mix = [t](double x, double y) { return static_cast<int>(std::lround(x + t * (y - x))); };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue));
}

/// Misfits from 0.1 to a power of ten above the largest, on a logarithmic scale from 0 to 1.
class MisfitScale {
 public:
  explicit MisfitScale(const std::vector<Scene>& scenes) {
    double largest = 1.0;
    for (const Scene& scene : scenes) {
      for (const Segment& segment : scene.closures) {
        if (std::isfinite(segment.misfit)) largest = std::max(largest, segment.misfit);
      }
    }
    top_ = std::max(1, static_cast<int>(std::ceil(std::log10(largest) - 1e-12)));
  }
  double position(double misfit) const {
    if (!(misfit > 0.1)) return 0.0;
    return std::min((std::log10(misfit) + 1.0) / (top_ + 1.0), 1.0);
  }
  int top() const { return top_; }

 private:
  int top_ = 1;
};

std::string escape(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// Maps a scene into its panel, y downwards.
class View {
 public:
  View(const Scene& scene, double left) {
    double minX = std::numeric_limits<double>::infinity(), maxX = -minX, minY = minX, maxY = -minX;
    for (const auto* points : {&scene.poses, &scene.landmarks}) {
      for (const PlanePoint& p : *points) {
        minX = std::min(minX, p.x), maxX = std::max(maxX, p.x);
        minY = std::min(minY, p.y), maxY = std::max(maxY, p.y);
      }
    }
    const double extent = std::max({maxX - minX, maxY - minY, 1e-9});
    scale_ = (panelSize - 2.0 * margin) / extent;
    x_ = left + panelSize / 2.0 - scale_ * (minX + maxX) / 2.0;
    y_ = headHeight + panelSize / 2.0 + scale_ * (minY + maxY) / 2.0;
  }
  std::string text(const PlanePoint& p) const {
    return fmt::format("{:.1f} {:.1f}", x_ + scale_ * p.x, y_ - scale_ * p.y);
  }
  double x(const PlanePoint& p) const { return x_ + scale_ * p.x; }
  double y(const PlanePoint& p) const { return y_ - scale_ * p.y; }
  double pixelsPerMetre() const { return scale_; }

 private:
  double scale_ = 1.0;
  double x_ = 0.0;
  double y_ = 0.0;
};

class Document {
 public:
  template <typename... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
    text_ += '\n';
  }
  /// One path of many separate lines.
  void addLines(const View& view, const std::vector<const Segment*>& segments, const std::string& style) {
    if (segments.empty()) return;
    text_ += "<path d=\"";
    for (const Segment* segment : segments)
      text_ += fmt::format("M{}L{}", view.text(segment->from), view.text(segment->to));
    text_ += fmt::format("\" {}/>\n", style);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::vector<const Segment*> pointers(const std::vector<Segment>& segments) {
  std::vector<const Segment*> result;
  for (const Segment& segment : segments) result.push_back(&segment);
  return result;
}

/// A bar of 1, 2 or 5 times a power of ten metres, about a fifth of the panel.
void drawScaleBar(Document& document, const View& view, double left) {
  const double wanted = panelSize / 5.0 / view.pixelsPerMetre();
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double metres = wanted >= 5.0 * power ? 5.0 * power : wanted >= 2.0 * power ? 2.0 * power : power;
  const double width = metres * view.pixelsPerMetre();
  const double x = left + margin;
  const double y = headHeight + panelSize - 10.0;
  document.add("<path d=\"M{:.1f} {:.1f}v-5h{:.1f}v5\" class=\"bar\"/>", x, y, width);
  document.add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"small\">{:g} m</text>", x + width + 6.0, y, metres);
}

void drawAxes(Document& document, double left) {
  const double x = left + panelSize - 56.0;
  const double y = headHeight + 48.0;
  document.add("<path d=\"M{0:.1f} {1:.1f}l20.8 12M{0:.1f} {1:.1f}l20.8 -12M{0:.1f} {1:.1f}v-24\" class=\"bar\"/>", x,
               y);
  document.add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"small\">x</text>", x + 24.0, y + 18.0);
  document.add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"small\">y</text>", x + 24.0, y - 10.0);
  document.add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"small\">z</text>", x - 3.0, y - 28.0);
}

void drawPanel(Document& document, const Scene& scene, const MisfitScale& scale, double left) {
  const View view(scene, left);
  document.add("<text x=\"{:.1f}\" y=\"24\" class=\"title\">{}</text>", left + margin, escape(scene.title));
  std::string facts = fmt::format("{} poses, ", scene.poses.size());
  if (!scene.landmarks.empty()) facts += fmt::format("{} landmarks, ", scene.landmarks.size());
  facts += fmt::format("{} loop closures", scene.closures.size());
  if (std::isfinite(scene.chi2)) facts += fmt::format(", chi2 {:.6g}", scene.chi2);
  if (scene.left > 0) facts += fmt::format(" ({} vertices not drawn)", scene.left);
  document.add("<text x=\"{:.1f}\" y=\"43\" class=\"small\">{}</text>", left + margin, facts);
  document.add("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"frame\"/>", left + 8.0,
               headHeight, panelSize - 16.0, panelSize);
  document.addLines(view, pointers(scene.sightings), "class=\"sighting\"");
  // Closures that fit lie below those that do not.
  std::vector<std::vector<const Segment*>> bins(shades);
  for (const Segment& segment : scene.closures) {
    const auto bin = static_cast<int>(scale.position(segment.misfit) * (shades - 1) + 0.5);
    bins[static_cast<std::size_t>(bin)].push_back(&segment);
  }
  for (int i = 0; i < shades; ++i) {
    document.addLines(view, bins[static_cast<std::size_t>(i)],
                      fmt::format("class=\"closure\" stroke=\"{}\"", shadeColour(i / (shades - 1.0))));
  }
  document.addLines(view, pointers(scene.odometry), "class=\"odometry\"");
  for (const PlanePoint& point : scene.landmarks)
    document.add("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" class=\"landmark\"/>", view.x(point), view.y(point));
  drawScaleBar(document, view, left);
  if (scene.spatial) drawAxes(document, left);
}

void drawLegend(Document& document, const MisfitScale& scale, double width) {
  const double y = headHeight + panelSize + 26.0;
  document.add("<path d=\"M{:.1f} {:.1f}h36\" class=\"odometry\"/>", margin, y);
  document.add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"small\">consecutive poses</text>", margin + 44.0, y + 4.0);
  const double left = margin + 190.0;
  const double length = std::min(320.0, width - left - margin);
  document.add("<defs><linearGradient id=\"misfit\">");
  for (int i = 0; i <= 10; ++i) document.add("<stop offset=\"{}%\" stop-color=\"{}\"/>", i * 10, shadeColour(i / 10.0));
  document.add("</linearGradient></defs>");
  document.add("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"10\" fill=\"url(#misfit)\"/>", left, y - 6.0,
               length);
  const int step = std::max(1, (scale.top() + 1) / 5);
  for (int exponent = -1; exponent <= scale.top(); exponent += step) {
    const double x = left + length * (exponent + 1.0) / (scale.top() + 1.0);
    document.add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"small\" text-anchor=\"middle\">{:g}</text>", x, y + 19.0,
                 std::pow(10.0, exponent));
  }
  document.add(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"small\">loop closures: chi2 over dimension (1: as expected)</text>",
      left, y + 38.0);
}

}  // namespace

std::string drawSvg(const std::vector<Scene>& scenes) {
  const MisfitScale scale(scenes);
  const double width = panelSize * static_cast<double>(scenes.size());
  const double height = headHeight + panelSize + footHeight;
  Document document;
  document.add(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" font-family=\"sans-serif\">",
      width, height);
  document.add(
      "<style>.frame{{fill:none;stroke:#d5d5d5}}.title{{font-size:15px;font-weight:600;fill:#222}}"
      ".small{{font-size:12px;fill:#555}}.bar{{fill:none;stroke:#555}}"
      ".odometry{{fill:none;stroke:#1d1d1d;stroke-width:1.1;stroke-linecap:round}}"
      ".closure{{fill:none;stroke-width:.8;stroke-opacity:.75}}.sighting{{fill:none;stroke:#c9c9c9;stroke-width:.5}}"
      ".landmark{{fill:#2c8a57}}</style>");
  document.add("<rect width=\"{:.0f}\" height=\"{:.0f}\" fill=\"#fff\"/>", width, height);
  for (std::size_t i = 0; i < scenes.size(); ++i)
    drawPanel(document, scenes[i], scale, panelSize * static_cast<double>(i));
  drawLegend(document, scale, width);
  document.add("</svg>");
  return document.text();
}

}  // namespace quiver::app
