#include <quiver/apps/simulate/bundle.h>

#include <algorithm>
#include <vector>

#include <quiver/core/io/bal/bal_format.h>
#include <quiver/core/io/files/graph_format.h>
#include <quiver/core/io/files/output_file.h>
#include <quiver/core/io/text/number_writer.h>
#include <quiver/core/util/parallel.h>

namespace quiver::app {
namespace {

using Vector3 = Vector<double, 3>;

constexpr std::int64_t pointsPerTask = 512;
constexpr std::int64_t tasksPerWrite = 64;

/// One way to write the numbers of a problem.
class BundleText {
 public:
  BundleText(bool bal, const detail::BalTypes& types, double pixelNoise)
      : bal_(bal), types_(types), weight_(pixelNoise > 0.0 ? 1.0 / (pixelNoise * pixelNoise) : 1.0) {}

  bool bal() const { return bal_; }

  void header(const BundleCounts& counts, NumberWriter& out) const {
    if (!bal_) return;
    numbers({static_cast<double>(counts.cameras), static_cast<double>(counts.points),
             static_cast<double>(counts.observations)},
            out);
  }
  void observation(int camera, std::int64_t point, std::int64_t pointId, const Vector<double, 2>& pixel,
                   NumberWriter& out) const {
    if (!bal_) out.text(types_.observation->tag() + " ");
    out.integer(camera);
    out.character(' ');
    out.integer(bal_ ? point : pointId);
    for (const double value : {pixel[0], pixel[1]}) append(value, out);
    if (!bal_) {
      for (const double value : {weight_, 0.0, weight_}) append(value, out);
    }
    out.character('\n');
  }
  void camera(int id, const BalCamera<double>& camera, NumberWriter& out) const {
    const Vector3 turn = SO3<double>::fromMatrix(camera.rotation).log();
    const Vector3 &t = camera.translation, &k = camera.intrinsics;
    vertex(*types_.camera, id, {turn[0], turn[1], turn[2], t[0], t[1], t[2], k[0], k[1], k[2]}, out);
  }
  void point(std::int64_t id, const Vector3& position, NumberWriter& out) const {
    vertex(*types_.point, id, {position[0], position[1], position[2]}, out);
  }

 private:
  static void append(double value, NumberWriter& out) {
    out.character(' ');
    out.real(value);
  }
  static void numbers(std::initializer_list<double> values, NumberWriter& out) {
    bool first = true;
    for (const double value : values) {
      if (!first) out.character(' ');
      out.real(value);
      first = false;
    }
    out.character('\n');
  }
  void vertex(const VertexType& type, std::int64_t id, std::initializer_list<double> values, NumberWriter& out) const {
    if (bal_) {
      for (const double value : values) {
        out.real(value);
        out.character('\n');
      }
      return;
    }
    out.text(type.tag() + " ");
    out.integer(id);
    for (const double value : values) append(value, out);
    out.character('\n');
  }

  bool bal_;
  const detail::BalTypes& types_;
  double weight_;
};

class BundleWriter {
 public:
  BundleWriter(const BundleSettings& settings, const Registry& registry, int threads)
      : settings_(settings), types_(registry), scene_(settings), threads_(threads > 0 ? threads : hardwareThreads()) {
    counts_ = {scene_.cameras(), settings.points, 0};
    countObservations();
  }

  const BundleCounts& counts() const { return counts_; }

  void write(const std::string& path, bool noisy) const {
    OutputFile file(path);
    const BundleText text(formatOfPath(path) == GraphFormat::bal, types_, settings_.pixelNoise);
    NumberWriter head;
    text.header(counts_, head);
    file.write(head.view());
    // BAL has the observations first, .g2o the vertices.
    if (text.bal()) writeObservations(text, file);
    writeCameras(text, noisy, file);
    writePoints(text, noisy, file);
    if (!text.bal()) writeObservations(text, file);
    file.commit();
  }

 private:
  /// Calls task(first point, last, out) for pieces of the points, and writes their texts in order.
  template <typename Task>
  void inPieces(OutputFile* file, Task task) const {
    std::vector<NumberWriter> texts(static_cast<std::size_t>(tasksPerWrite));
    for (std::int64_t first = 0; first < settings_.points; first += pointsPerTask * tasksPerWrite) {
      const std::int64_t tasks =
          std::min(tasksPerWrite, (settings_.points - first + pointsPerTask - 1) / pointsPerTask);
      parallelFor(tasks, threads_, [&](std::int64_t t) {
        NumberWriter& out = texts[static_cast<std::size_t>(t)];
        out.clear();
        const std::int64_t begin = first + t * pointsPerTask;
        task(begin, std::min(begin + pointsPerTask, settings_.points), out);
      });
      for (std::int64_t t = 0; file && t < tasks; ++t) file->write(texts[static_cast<std::size_t>(t)].view());
    }
  }

  void countObservations() {
    std::vector<std::int64_t> found(static_cast<std::size_t>((settings_.points + pointsPerTask - 1) / pointsPerTask));
    inPieces(nullptr, [&](std::int64_t begin, std::int64_t end, NumberWriter&) {
      std::vector<int> track;
      std::int64_t count = 0;
      for (std::int64_t i = begin; i < end; ++i) {
        scene_.point(i, track);
        count += static_cast<std::int64_t>(track.size());
      }
      found[static_cast<std::size_t>(begin / pointsPerTask)] = count;
    });
    for (const std::int64_t count : found) counts_.observations += count;
  }

  void writeObservations(const BundleText& text, OutputFile& file) const {
    inPieces(&file, [&](std::int64_t begin, std::int64_t end, NumberWriter& out) {
      std::vector<int> track;
      for (std::int64_t i = begin; i < end; ++i) {
        const Vector3 position = scene_.point(i, track);
        ElementRandom random(settings_.seed, static_cast<std::uint64_t>(i), 3);
        for (const int camera : track) {
          const BalCamera<double>& c = scene_.camera(camera);
          Vector<double, 2> pixel = CameraSnavely::project<double>(c.intrinsics, c.seen(position));
          const bool outlier = random.uniform() <= settings_.outliers && settings_.outliers > 0.0;
          for (int k = 0; k < 2; ++k) {
            const double half = k == 0 ? BundleScene::halfWidth : BundleScene::halfHeight;
            pixel[k] = outlier ? random.uniform(-half, half) : pixel[k] + settings_.pixelNoise * random.normal();
          }
          text.observation(camera, i, counts_.cameras + i, pixel, out);
        }
      }
    });
  }

  void writeCameras(const BundleText& text, bool noisy, OutputFile& file) const {
    NumberWriter out;
    for (int i = 0; i < scene_.cameras(); ++i) {
      BalCamera<double> camera = scene_.camera(i);
      if (noisy) {
        ElementRandom random(settings_.seed, static_cast<std::uint64_t>(i), 4);
        const Vector3 turn = random.normal3(settings_.rotationError);
        const Vector3 position = -(camera.rotation.transpose() * camera.translation);
        camera.rotation = SO3<double>::exp(turn).matrix() * camera.rotation;
        camera.translation = -(camera.rotation * (position + random.normal3(settings_.positionError)));
        camera.intrinsics[0] *= 1.0 + 0.005 * random.normal();
      }
      text.camera(i, camera, out);
    }
    file.write(out.view());
  }

  void writePoints(const BundleText& text, bool noisy, OutputFile& file) const {
    inPieces(&file, [&](std::int64_t begin, std::int64_t end, NumberWriter& out) {
      std::vector<int> track;
      for (std::int64_t i = begin; i < end; ++i) {
        Vector3 position = scene_.point(i, track);
        if (noisy)
          position += ElementRandom(settings_.seed, static_cast<std::uint64_t>(i), 5).normal3(settings_.pointError);
        text.point(counts_.cameras + i, position, out);
      }
    });
  }

  BundleSettings settings_;
  detail::BalTypes types_;
  BundleScene scene_;
  int threads_;
  BundleCounts counts_;
};

}  // namespace

BundleCounts writeBundle(const BundleSettings& settings, const Registry& registry, const std::string& path,
                         const std::string& truth, int threads) {
  const BundleWriter writer(settings, registry, threads);
  writer.write(path, true);
  if (!truth.empty()) writer.write(truth, false);
  return writer.counts();
}

}  // namespace quiver::app
