#pragma once

#include <array>
#include <cstdint>

#include <quiver/core/graph/change_flag.h>
#include <quiver/geometry/packing.h>

namespace quiver {

class Graph;

/// A constant that edges share: a sensor's pose, a camera's intrinsics. Known in its graph by an id of its own name
/// space. Assigning one to another copies the value alone.
class Parameter {
 public:
  Parameter() = default;
  Parameter(const Parameter&) = default;
  Parameter& operator=(const Parameter&) {
    change_.raise();
    return *this;
  }

  std::int64_t id() const { return id_; }
  /// Index of its type in the registry of its graph.
  int type() const { return type_; }

 protected:
  /// To be called after a change of the value.
  void noteChange() { change_.raise(); }

 private:
  friend class Graph;
  ChangeLink change_;
  std::int64_t id_ = -1;
  std::uint16_t type_ = 0;
};

/// A parameter is a value; edges that name it in their `ParameterList` get it after their measurement.
template <typename Derived, typename ValueType>
class BaseParameter : public Parameter {
 public:
  using Value = ValueType;

  ValueType value() const { return Packing<ValueType>::template load<double>(values_.data()); }
  void setValue(const ValueType& value) {
    Packing<ValueType>::store(value, values_.data());
    noteChange();
  }
  const double* values() const { return values_.data(); }

 private:
  std::array<double, static_cast<std::size_t>(Packing<ValueType>::size)> values_ = detail::defaultNumbers<ValueType>();
};

/// The parameters an edge type uses, in the order in which files list their ids and `computeError` takes their values.
template <typename... ParameterTypes>
struct ParameterList {
  static constexpr int size = sizeof...(ParameterTypes);
};

}  // namespace quiver
