#include <quiver/apps/evaluate/trajectory_svg.h>

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace quiver::app {
namespace {

constexpr double size = 800.0;
constexpr double margin = 40.0;

using Poses = std::vector<SE3<double>>;

/// Maps two of three axes to the page.
class View {
 public:
  explicit View(const TrajectoryError& error) {
    Vector<double, 3> least = error.truth.front().translation();
    Vector<double, 3> largest = least;
    for (const SE3<double>& pose : error.truth) include(pose, least, largest);
    const Vector<double, 3> extent = largest - least;
    int hidden = 2;
    for (int axis = 0; axis < 3; ++axis) {
      if (extent[axis] < extent[hidden]) hidden = axis;
    }
    axes_ = {hidden == 0 ? 1 : 0, hidden == 2 ? 1 : 2};
    for (const SE3<double>& pose : error.estimate) include(pose, least, largest);
    const double width = std::max({largest[axes_[0]] - least[axes_[0]], largest[axes_[1]] - least[axes_[1]], 1e-9});
    scale_ = (size - 2.0 * margin) / width;
    left_ = least[axes_[0]];
    top_ = largest[axes_[1]];
  }
  std::string place(const SE3<double>& pose) const {
    const Vector<double, 3> t = pose.translation();
    return fmt::format("{:.2f} {:.2f}", margin + scale_ * (t[axes_[0]] - left_),
                       margin + scale_ * (top_ - t[axes_[1]]));
  }
  char axisName(int i) const { return "xyz"[axes_[static_cast<std::size_t>(i)]]; }

 private:
  static void include(const SE3<double>& pose, Vector<double, 3>& least, Vector<double, 3>& largest) {
    least = least.cwiseMin(pose.translation());
    largest = largest.cwiseMax(pose.translation());
  }
  std::array<int, 2> axes_{0, 1};
  double scale_ = 1.0;
  double left_ = 0.0;
  double top_ = 0.0;
};

std::string path(const View& view, const Poses& poses, const char* colour) {
  std::string d;
  for (const SE3<double>& pose : poses) d += fmt::format("{}{}", d.empty() ? "M" : "L", view.place(pose));
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", d, colour);
}

}  // namespace

std::string drawTrajectories(const TrajectoryError& error, AlignmentGroup group) {
  const View view(error);
  std::string offsets;
  for (std::size_t i = 0; i < error.truth.size(); ++i)
    offsets += fmt::format("M{}L{}", view.place(error.truth[i]), view.place(error.estimate[i]));
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {0:.0f}\" font-family=\"sans-serif\" "
             "font-size=\"14\">\n<rect width=\"{0:.0f}\" height=\"{0:.0f}\" fill=\"white\"/>\n",
             size) +
         fmt::format("<path d=\"{}\" stroke=\"#d62728\" stroke-width=\"0.5\"/>\n", offsets) +
         path(view, error.truth, "#7f7f7f") + path(view, error.estimate, "#1f77b4") +
         fmt::format(
             "<text x=\"10\" y=\"20\"><tspan fill=\"#7f7f7f\">truth</tspan> <tspan fill=\"#1f77b4\">estimate "
             "({})</tspan> <tspan fill=\"#d62728\">error, rms {:.4g} m</tspan></text>\n"
             "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\">{} to the right, {} up</text>\n</svg>\n",
             nameOf(group), error.absoluteTranslation.rootMeanSquare, size - 10.0, size - 10.0, view.axisName(0),
             view.axisName(1));
}

}  // namespace quiver::app
