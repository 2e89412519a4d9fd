// The objects that the device supports, with their parameters, and the extensions of ANARI that it
// implements.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "device/types.h"

namespace raio::device {

struct ParameterInfo {
  std::string name;
  std::vector<DataType> types;
  std::string description;
  std::vector<float> default_value = {};  ///< numbers of the first type; empty: none
  std::vector<const char*> words = {};    ///< of strings, the default first, nullptr last
  std::vector<DataType> elements = {};    ///< of arrays
  bool required = false;
  std::vector<float> minimum = {}, maximum = {};
  std::array<int32_t, 3> whole = {};  ///< default, minimum and maximum of integers
};

/// ANARI's own type of an entry in a list of parameters.
struct ParameterEntry {
  const char* name;
  int type;
};

struct ObjectInfo {
  DataType type;
  std::string subtype;  ///< empty: the type has only one
  std::string description;
  std::vector<ParameterInfo> parameters;
  std::vector<ParameterEntry> entries = {};  ///< of all parameters and types, {nullptr, 0} last

  const ParameterInfo* find(std::string_view name) const;
};

/// Null if the device has no such object.
const ObjectInfo* object_info(DataType type, std::string_view subtype);
/// The names, nullptr last; null if the type has only one.
const char** subtypes_of(DataType type);
/// The names, nullptr last.
const char** extensions();
/// A property of an object's description, as ANARI names and types it; null if there is none.
const void* object_property(DataType type, std::string_view subtype, std::string_view name,
                            DataType as);
/// The same of a parameter: default, minimum, maximum, required, description, value, elementType.
const void* parameter_property(DataType type, std::string_view subtype, std::string_view parameter,
                               DataType parameter_type, std::string_view name, DataType as);

}  // namespace raio::device
