#include <quiver/apps/plot/svg_plot.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/ranges.h>

#include <quiver/apps/support/counted.h>
#include <quiver/core/util/error.h>

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

/// The rectangle that a scene is drawn from.
struct Extent {
  double minX = std::numeric_limits<double>::infinity();
  double maxX = -minX;
  double minY = minX;
  double maxY = -minX;

  void include(const PlanePoint& p) {
    minX = std::min(minX, p.x), maxX = std::max(maxX, p.x);
    minY = std::min(minY, p.y), maxY = std::max(maxY, p.y);
  }
  double side() const { return std::max(maxX - minX, maxY - minY); }
};

/// Of all poses and landmarks; of poses and the central landmarks where a few of the others, as points that cameras saw
/// under hardly any parallax, would make the picture several times as large.
Extent extentOf(const Scene& scene) {
  constexpr double tail = 0.02, fewTimes = 3.0;
  Extent poses;
  for (const PlanePoint& p : scene.poses) poses.include(p);
  Extent all = poses;
  for (const PlanePoint& p : scene.landmarks) all.include(p);
  const auto left = static_cast<std::ptrdiff_t>(tail * static_cast<double>(scene.landmarks.size()));
  if (left == 0) return all;
  Extent central = poses;
  std::vector<double> xs, ys;
  for (const PlanePoint& p : scene.landmarks) {
    xs.push_back(p.x);
    ys.push_back(p.y);
  }
  std::sort(xs.begin(), xs.end());
  std::sort(ys.begin(), ys.end());
  const auto last = static_cast<std::ptrdiff_t>(xs.size()) - 1 - left;
  central.include({xs[static_cast<std::size_t>(left)], ys[static_cast<std::size_t>(left)]});
  central.include({xs[static_cast<std::size_t>(last)], ys[static_cast<std::size_t>(last)]});
  return all.side() > fewTimes * central.side() ? central : all;
}

/// Maps a scene into its panel, y downwards.
class View {
 public:
  View(const Scene& scene, double left) : left_(left) {
    constexpr double point = 1e-9;
    const Extent extent = extentOf(scene);
    scale_ = (panelSize - 2.0 * margin) / (extent.side() > point ? extent.side() : 1.0);
    x_ = left + panelSize / 2.0 - scale_ * (extent.minX / 2.0 + extent.maxX / 2.0);
    y_ = headHeight + panelSize / 2.0 + scale_ * (extent.minY / 2.0 + extent.maxY / 2.0);
  }
  std::string text(const PlanePoint& p) const {
    // What lies far beyond the frame has no number on the page.
    constexpr double beyond = 1e6;
    return fmt::format("{:.1f} {:.1f}", std::clamp(x_ + scale_ * p.x, -beyond, beyond),
                       std::clamp(y_ - scale_ * p.y, -beyond, beyond));
  }
  /// Whether the panel shows the point.
  bool shows(const PlanePoint& p) const {
    const double x = x_ + scale_ * p.x - left_;
    const double y = y_ - scale_ * p.y - headHeight;
    return x >= 0.0 && x <= panelSize && y >= 0.0 && y <= panelSize;
  }
  double pixelsPerMetre() const { return scale_; }

 private:
  double left_ = 0.0;
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
  /// One path of dots: lines of no length, whose ends the style makes round or square.
  void addDots(const View& view, const std::vector<PlanePoint>& points, const std::string& style) {
    if (points.empty()) return;
    text_ += "<path d=\"";
    for (const PlanePoint& point : points) {
      if (view.shows(point)) text_ += fmt::format("M{}h0", view.text(point));
    }
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

/// More lines to landmarks than these are a grey area and a large file.
constexpr std::size_t mostSightings = 20000;

std::string factsOf(const Scene& scene, const View& view) {
  const auto size = [](const auto& list) { return static_cast<std::int64_t>(list.size()); };
  std::string facts = counted(size(scene.poses), "pose") + ", ";
  if (!scene.landmarks.empty()) facts += counted(size(scene.landmarks), "landmark") + ", ";
  facts += counted(size(scene.closures), "loop closure");
  if (std::isfinite(scene.chi2)) facts += fmt::format(", chi2 {:.6g}", scene.chi2);
  std::vector<std::string> missing;
  if (scene.withoutEstimate > 0)
    missing.push_back(counted(scene.withoutEstimate, "vertex", "vertices") + " without estimate");
  if (scene.withoutPlace > 0) missing.push_back(counted(scene.withoutPlace, "vertex", "vertices") + " without place");
  const auto outside = std::count_if(scene.landmarks.begin(), scene.landmarks.end(),
                                     [&view](const PlanePoint& p) { return !view.shows(p); });
  if (outside > 0) missing.push_back(counted(outside, "landmark") + " beyond the frame");
  if (scene.sightings.size() > mostSightings) missing.push_back(counted(size(scene.sightings), "sighting"));
  if (!missing.empty()) facts += fmt::format("; not drawn: {}", fmt::join(missing, ", "));
  return facts;
}

void drawPanel(Document& document, const Scene& scene, const MisfitScale& scale, double left) {
  const View view(scene, left);
  document.add("<text x=\"{:.1f}\" y=\"24\" class=\"title\">{}</text>", left + margin, escape(scene.title));
  document.add("<text x=\"{:.1f}\" y=\"43\" class=\"small\">{}</text>", left + margin, factsOf(scene, view));
  const std::string frame = fmt::format("x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"", left + 8.0,
                                        headHeight, panelSize - 16.0, panelSize);
  document.add("<rect {} class=\"frame\"/>", frame);
  document.add("<clipPath id=\"panel{0:.0f}\"><rect {1}/></clipPath>\n<g clip-path=\"url(#panel{0:.0f})\">", left,
               frame);
  if (scene.sightings.size() <= mostSightings) document.addLines(view, pointers(scene.sightings), "class=\"sighting\"");
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
  document.addDots(view, scene.landmarks, "class=\"landmark\"");
  document.addDots(view, scene.lonePoses, "class=\"pose\"");
  document.add("</g>");
  drawScaleBar(document, view, left);
  if (scene.spatial) drawAxes(document, left);
}

/// What squares and dots are, where there are any.
void drawDotLegend(Document& document, const std::vector<Scene>& scenes, double y) {
  const auto entry = [&document](double at, const char* style, const char* text) {
    document.add("<path d=\"M{:.1f} {:.1f}h0\" class=\"{}\"/>", margin + 18.0, at, style);
    document.add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"small\">{}</text>", margin + 44.0, at + 4.0, text);
  };
  const auto any = [&scenes](std::vector<PlanePoint> Scene::*list) {
    return std::any_of(scenes.begin(), scenes.end(), [list](const Scene& scene) { return !(scene.*list).empty(); });
  };
  if (any(&Scene::lonePoses)) entry(y, "pose", "poses not joined");
  if (any(&Scene::landmarks)) entry(y + 17.0, "landmark", "landmarks");
}

void drawLegend(Document& document, const std::vector<Scene>& scenes, const MisfitScale& scale, double width) {
  const double y = headHeight + panelSize + 26.0;
  drawDotLegend(document, scenes, y + 17.0);
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

void checkExtent(const Scene& scene) {
  if (!std::isfinite(extentOf(scene).side()))
    throw GraphError("the extent of the estimates is not finite: there is no scale to draw them to");
}

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
      ".landmark{{stroke:#2c8a57;stroke-width:4;stroke-linecap:round}}"
      ".pose{{stroke:#1d1d1d;stroke-width:5;stroke-linecap:square}}</style>");
  document.add("<rect width=\"{:.0f}\" height=\"{:.0f}\" fill=\"#fff\"/>", width, height);
  for (std::size_t i = 0; i < scenes.size(); ++i)
    drawPanel(document, scenes[i], scale, panelSize * static_cast<double>(i));
  drawLegend(document, scenes, scale, width);
  document.add("</svg>");
  return document.text();
}

}  // namespace quiver::app
