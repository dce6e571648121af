#include <quiver/core/io/g2o/g2o_reader.h>

#include <quiver/core/io/bal/bal_format.h>
#include <quiver/core/io/bal/bal_reader.h>
#include <quiver/core/io/csv/csv_text.h>
#include <quiver/core/io/files/input_file.h>
#include <quiver/core/io/g2o/g2o_loader.h>

namespace quiver {

Graph readGraph(const std::string& path, std::shared_ptr<const Registry> registry, const ReadOptions& options) {
  const InputFile file(path);
  Graph graph = readGraphText(file.text(), file.name(), std::move(registry), options);
  if (options.report) options.report->storedBytes = file.storedBytes();
  return graph;
}

Graph readGraphText(std::string_view text, const std::string& name, std::shared_ptr<const Registry> registry,
                    const ReadOptions& options) {
  if (!registry) throw GraphError("reading a graph needs a registry");
  const detail::SourceText source{text, name};
  if (options.report) {
    *options.report = {};
    options.report->format = "g2o";
    options.report->storedBytes = options.report->textBytes = static_cast<std::int64_t>(text.size());
  }
  if (detail::looksLikeBal(text)) return detail::loadBal(source, std::move(registry), options);
  if (detail::looksLikeCsv(text)) {
    const std::string lines = detail::linesOfCsv(source);
    Graph graph = detail::G2oLoader({lines, name}, std::move(registry), options).load();
    if (options.report) options.report->format = "csv";
    return graph;
  }
  return detail::G2oLoader(source, std::move(registry), options).load();
}

}  // namespace quiver
