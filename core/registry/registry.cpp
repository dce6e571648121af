#include <quiver/core/registry/registry.h>

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

struct StringHash {
  using is_transparent = void;
  std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
};
template <typename Value>
using StringMap = std::unordered_map<std::string, Value, StringHash, std::equal_to<>>;

template <typename Value>
Value findOr(const StringMap<Value>& map, std::string_view key, Value otherwise) {
  const auto it = map.find(key);
  return it == map.end() ? otherwise : it->second;
}

bool sameLetter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

bool equalIgnoringCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

bool isWord(std::string_view text) { return !text.empty() && text.find_first_of(" \t\r\n\v\f") == text.npos; }

template <typename Entry>
const NamedEntry<Entry>* findNamed(const std::vector<NamedEntry<Entry>>& entries, std::string_view name) {
  for (const auto& entry : entries) {
    if (equalIgnoringCase(entry.name, name)) return &entry;
  }
  return nullptr;
}

/// Throws GraphError unless it can be named on a command line, and called.
void checkEntry(std::string_view kind, std::string_view name, bool callable) {
  if (!isWord(name)) throw GraphError(fmt::format("'{}' cannot name a {}: a name is one word", name, kind));
  if (!callable) throw GraphError(fmt::format("{} '{}' has no function to call", kind, name));
}

template <typename Entry>
const Entry* valueOf(const NamedEntry<Entry>* entry) {
  return entry ? &entry->value : nullptr;
}

}  // namespace

struct Registry::Lookup {
  template <typename Type>
  struct Family {
    StringMap<const Type*> byTag;
    StringMap<const Type*> byName;
  };
  Family<VertexType> vertices;
  Family<EdgeType> edges;
  Family<ParameterType> parameters;
  StringMap<int> dataTags;

  template <typename Type>
  static const Type& insert(Family<Type>& family, std::vector<std::unique_ptr<Type>>& types,
                            std::unique_ptr<Type> type) {
    const auto [known, isNew] = family.byName.emplace(std::string(type->cppName()), type.get());
    if (!isNew) {
      throw GraphError(fmt::format("type {} is registered as '{}' already, not again as '{}'", type->cppName(),
                                   known->second->tag(), type->tag()));
    }
    family.byTag.emplace(type->tag(), type.get());
    types.push_back(std::move(type));
    return *types.back();
  }
};

Registry::Registry() : lookup_(std::make_unique<Lookup>()) {}
Registry::~Registry() = default;

void Registry::claimTag(const std::string& tag) const {
  const char first = isWord(tag) ? tag.front() : '#';
  if (first == '#' || (first >= '0' && first <= '9') || tag == "FIX" || tag.find_first_of(",\"") != tag.npos) {
    throw GraphError(fmt::format(
        "'{}' cannot be a tag: a tag is one word without commas and quotes, not FIX, not beginning with # or a digit",
        tag));
  }
  if (findVertexType(tag) || findEdgeType(tag) || findParameterType(tag) || isDataTag(tag)) {
    throw GraphError(fmt::format("tag '{}' is registered already", tag));
  }
}

const VertexType& Registry::add(std::unique_ptr<VertexType> type) {
  if (!type) throw GraphError("there is no type to register");
  claimTag(type->tag());
  type->index_ = static_cast<int>(vertexTypes_.size());
  return Lookup::insert(lookup_->vertices, vertexTypes_, std::move(type));
}

const ParameterType& Registry::add(std::unique_ptr<ParameterType> type) {
  if (!type) throw GraphError("there is no type to register");
  claimTag(type->tag());
  type->index_ = static_cast<int>(parameterTypes_.size());
  return Lookup::insert(lookup_->parameters, parameterTypes_, std::move(type));
}

const EdgeType& Registry::add(std::unique_ptr<EdgeType> type) {
  if (!type) throw GraphError("there is no type to register");
  claimTag(type->tag());
  for (int role = 0; role < type->arity(); ++role) {
    if (!findVertexTypeByName(type->vertexTypeName(role))) {
      throw GraphError(fmt::format("edge '{}' joins {}, which is not registered; register the vertex type first",
                                   type->tag(), type->vertexTypeName(role)));
    }
  }
  for (const std::string_view name : type->parameterTypeNames()) {
    if (!findParameterTypeByName(name)) {
      throw GraphError(fmt::format("edge '{}' uses {}, which is not registered; register the parameter type first",
                                   type->tag(), name));
    }
  }
  type->index_ = static_cast<int>(edgeTypes_.size());
  return Lookup::insert(lookup_->edges, edgeTypes_, std::move(type));
}

void Registry::addAlias(std::string alias, const std::string& tag) {
  claimTag(alias);
  if (const VertexType* vertex = findVertexType(tag)) {
    lookup_->vertices.byTag.emplace(alias, vertex);
  } else if (const EdgeType* edge = findEdgeType(tag)) {
    lookup_->edges.byTag.emplace(alias, edge);
  } else if (const ParameterType* parameter = findParameterType(tag)) {
    lookup_->parameters.byTag.emplace(alias, parameter);
  } else {
    throw GraphError(fmt::format("alias '{}' of '{}', which is not registered", alias, tag));
  }
  aliases_.emplace_back(std::move(alias), tag);
}

void Registry::addDataTag(std::string tag, std::string documentation) {
  claimTag(tag);
  lookup_->dataTags.emplace(tag, 0);
  dataTags_.push_back({std::move(tag), std::move(documentation), 0});
}

const VertexType* Registry::findVertexType(std::string_view tag) const {
  return findOr<const VertexType*>(lookup_->vertices.byTag, tag, nullptr);
}
const EdgeType* Registry::findEdgeType(std::string_view tag) const {
  return findOr<const EdgeType*>(lookup_->edges.byTag, tag, nullptr);
}
const ParameterType* Registry::findParameterType(std::string_view tag) const {
  return findOr<const ParameterType*>(lookup_->parameters.byTag, tag, nullptr);
}
bool Registry::isDataTag(std::string_view tag) const { return lookup_->dataTags.find(tag) != lookup_->dataTags.end(); }
const VertexType* Registry::findVertexTypeByName(std::string_view name) const {
  return findOr<const VertexType*>(lookup_->vertices.byName, name, nullptr);
}
const EdgeType* Registry::findEdgeTypeByName(std::string_view name) const {
  return findOr<const EdgeType*>(lookup_->edges.byName, name, nullptr);
}
const ParameterType* Registry::findParameterTypeByName(std::string_view name) const {
  return findOr<const ParameterType*>(lookup_->parameters.byName, name, nullptr);
}

void Registry::addLinearSystem(std::string name, std::string documentation, LinearSystemFactory factory) {
  checkEntry("linear solver", name, static_cast<bool>(factory));
  if (findLinearSystem(name)) throw GraphError(fmt::format("linear solver '{}' is registered already", name));
  linearSystems_.push_back({std::move(name), std::move(documentation), std::move(factory)});
}

void Registry::addInitializer(std::string name, std::string documentation, Initializer initializer) {
  checkEntry("initialiser", name, static_cast<bool>(initializer));
  if (name == "file" || findInitializer(name))
    throw GraphError(fmt::format("initialiser '{}' is registered already", name));
  initializers_.push_back({std::move(name), std::move(documentation), std::move(initializer)});
}

void Registry::addAlgorithm(std::string name, std::string documentation, Algorithm algorithm) {
  checkEntry("algorithm", name, static_cast<bool>(algorithm.run));
  if (name == "auto" || findAlgorithm(name))
    throw GraphError(fmt::format("algorithm '{}' is registered already", name));
  algorithms_.push_back({std::move(name), std::move(documentation), std::move(algorithm)});
}

void Registry::addRobustKernel(const RobustKernelType& kernel) {
  if (!isWord(kernel.name) || equalIgnoringCase(kernel.name, "none"))
    throw GraphError(fmt::format("'{}' cannot name a robust kernel: a name is one word, not none", kernel.name));
  if (findRobustKernel(kernel.name))
    throw GraphError(fmt::format("robust kernel '{}' is registered already", kernel.name));
  robustKernels_.push_back(&kernel);
}

const LinearSystemFactory* Registry::findLinearSystem(std::string_view name) const {
  return valueOf(findNamed(linearSystems_, name));
}
const Initializer* Registry::findInitializer(std::string_view name) const {
  return valueOf(findNamed(initializers_, name));
}
const NamedEntry<Algorithm>* Registry::findAlgorithm(std::string_view name) const {
  return findNamed(algorithms_, name);
}
const RobustKernelType* Registry::findRobustKernel(std::string_view name) const {
  for (const RobustKernelType* kernel : robustKernels_) {
    if (equalIgnoringCase(kernel->name, name)) return kernel;
  }
  return nullptr;
}

std::vector<std::string> Registry::knownTags() const {
  std::vector<std::string> tags = {"FIX"};
  for (const auto& type : vertexTypes_) tags.push_back(type->tag());
  for (const auto& type : edgeTypes_) tags.push_back(type->tag());
  for (const auto& type : parameterTypes_) tags.push_back(type->tag());
  for (const auto& [alias, tag] : aliases_) tags.push_back(alias);
  for (const auto& entry : dataTags_) tags.push_back(entry.name);
  return tags;
}

std::string nearestWord(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  // Half of the letters at least are as they should be.
  std::size_t bestDistance = std::min(std::max<std::size_t>(2, word.size() / 3), word.size() / 2) + 1;
  if (word.size() > 64) return best;
  for (const std::string& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j <= candidate.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t substitute = diagonal + !sameLetter(word[i - 1], candidate[j - 1]);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
      }
    }
    if (row.back() < bestDistance) {
      bestDistance = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace quiver
