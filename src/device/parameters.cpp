#include "device/parameters.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <numbers>

namespace raio::device {

namespace {

using enum DataType;
using Parameters = std::vector<ParameterInfo>;

const std::vector<DataType> kAttributes = {float32, float32_vec2, float32_vec3, float32_vec4};

// Every type of colours: 8, 16 and 32 bits, sRGB and floats, one to four components.
std::vector<DataType> color_types() {
  std::vector<DataType> types;
  for (const int first : {1036, 1044, 1052, 1068, 2000})
    for (int k = 0; k < 4; ++k) types.push_back(DataType(first + k));
  return types;
}

Parameters operator+(Parameters a, const Parameters& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

ParameterInfo array_of(std::string name, std::vector<DataType> elements, std::string description,
                       bool required = false) {
  return {std::move(name),     {array1d}, std::move(description), {}, {},
          std::move(elements), required};
}

ParameterInfo number(std::string name, float default_value, std::string description) {
  return {std::move(name), {float32}, std::move(description), {default_value}};
}

ParameterInfo vector(std::string name, std::vector<float> default_value, std::string description) {
  return {std::move(name), {float32_vec3}, std::move(description), std::move(default_value)};
}

ParameterInfo words(std::string name, std::vector<const char*> words, std::string description) {
  words.push_back(nullptr);
  return {std::move(name), {string}, std::move(description), {}, std::move(words)};
}

const ParameterInfo kName = {"name", {string}, "name of the object"};
const std::vector<float> kNoTransform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// Uniform values, and arrays with a value per primitive, vertex or corner.
Parameters attributes(std::initializer_list<const char*> rates) {
  Parameters all;
  for (const char* attribute : {"color", "attribute0", "attribute1", "attribute2", "attribute3"}) {
    all.push_back({attribute, {float32_vec4}, "value on the whole geometry"});
    const bool is_color = attribute[0] == 'c';
    for (const std::string rate : rates)
      all.push_back(array_of(rate + "." + attribute, is_color ? color_types() : kAttributes,
                             "values on the geometry"));
  }
  return all;
}

ParameterInfo indices(std::vector<DataType> types, std::string description) {
  return array_of("primitive.index", std::move(types), std::move(description));
}

const ParameterInfo kPositions =
    array_of("vertex.position", {float32_vec3}, "positions of the vertices", true);
const ParameterInfo kRadii = array_of("vertex.radius", {float32}, "radii at the vertices");
const ParameterInfo kRadius = number("radius", 1, "radius without an array of radii");
const Parameters kCaps = {
    words("caps", {"none", "first", "second", "both"}, "ends that are closed"),
    array_of("vertex.cap", {DataType::uint8}, "whether the end at a vertex is closed")};

Parameters mesh_arrays(DataType indices32, DataType indices64) {
  Parameters all = {kPositions, indices({indices32, indices64}, "vertices of the primitives")};
  for (const char* rate : {"vertex", "faceVarying"}) {
    all.push_back(
        array_of(rate + std::string(".normal"), {float32_vec3, fixed16_vec3}, "shading normals"));
    all.push_back(array_of(rate + std::string(".tangent"),
                           {float32_vec3, fixed16_vec3, float32_vec4, fixed16_vec4}, "tangents"));
  }
  return all + attributes({"primitive", "vertex", "faceVarying"});
}

// A value, the name of an attribute, or a sampler.
ParameterInfo field(std::string name, std::vector<float> default_value, std::string description) {
  const DataType type = default_value.size() == 1 ? float32 : float32_vec3;
  return {
      std::move(name), {type, sampler, string}, std::move(description), std::move(default_value)};
}

const Parameters kAlpha = {
    words("alphaMode", {"opaque", "blend", "mask"}, "use of the opacity"),
    number("alphaCutoff", 0.5f, "opacity from which `mask` shows a primitive")};

Parameters image_sampler(DataType array, int dimensions) {
  Parameters all = {
      {"image", {array}, "the image", {}, {}, color_types(), true},
      words("inAttribute", {"attribute0", "attribute1", "attribute2", "attribute3", "color"},
            "attribute of the coordinates"),
      words("filter", {"linear", "nearest"}, "interpolation of texels"),
      {"borderColor", {float32_vec4}, "colour of clampToBorder", {0, 0, 0, 0}},
      {"inTransform", {float32_mat4}, "applied to coordinates", kNoTransform},
      {"inOffset", {float32_vec4}, "added to coordinates", {0, 0, 0, 0}},
      {"outTransform", {float32_mat4}, "applied to values", kNoTransform},
      {"outOffset", {float32_vec4}, "added to values", {0, 0, 0, 0}}};
  for (int k = 1; k <= dimensions; ++k)
    all.push_back(words(dimensions == 1 ? "wrapMode" : "wrapMode" + std::to_string(k),
                        {"clampToEdge", "repeat", "mirrorRepeat", "clampToBorder"},
                        "values outside the image"));
  return all;
}

const Parameters kCamera = {
    vector("position", {0, 0, 0}, "position of the eye"),
    // Not as in ANARI 1.1, where it is (0, 0, -1): its test suite and other devices rely on this.
    vector("direction", {0, 0, 1}, "direction of view"),
    vector("up", {0, 1, 0}, "up direction"),
    {"imageRegion", {float32_box2}, "part of the picture to render, from 0 to 1", {0, 0, 1, 1}},
    {"aspect", {float32}, "width over height of the picture; must be that of the frame"}};
const Parameters kLens = {number("apertureRadius", 0, "radius of the lens"),
                          number("focusDistance", 1, "distance of the plane in focus")};

const Parameters kLight = {vector("color", {1, 1, 1}, "colour of the light"),
                           {"visible", {boolean}, "whether eye rays see the light"}};
const ParameterInfo kLightPosition = vector("position", {0, 0, 0}, "position");
const ParameterInfo kLightDirection = vector("direction", {0, 0, -1}, "direction of the light");
const Parameters kIntensity = {number("intensity", 1, "light in a direction, W/sr"),
                               {"power", {float32}, "all light, W; replaces the intensity"}};
const ParameterInfo kLightRadiance = {
    "radiance", {float32}, "light of a point in a direction, W/sr/m^2"};
const Parameters kCone = {
    number("openingAngle", float(std::numbers::pi), "full angle of the cone, radians"),
    number("falloffAngle", 0.1f, "width of the cone's border, radians")};

const Parameters kContents = {array_of("surface", {surface}, "surfaces"),
                              array_of("volume", {volume}, "volumes"),
                              array_of("light", {light}, "lights")};

// NOLINTNEXTLINE(readability-function-size): a list
std::deque<ObjectInfo> make_objects() {
  std::deque<ObjectInfo> all;
  const auto add = [&](DataType type, const char* subtype, const char* description,
                       const Parameters& own) {
    all.push_back({type, subtype, description, Parameters{kName} + own});
  };
  add(device, "", "ray tracer for figures of particles, molecules and meshes",
      {{"statusCallback", {status_callback}, "receives messages"},
       {"statusCallbackUserData", {void_pointer}, "passed to it"}});

  add(geometry, "sphere", "spheres",
      Parameters{kPositions, kRadii, kRadius,
                 indices({DataType::uint32, DataType::uint64}, "vertices that are spheres")} +
          attributes({"primitive", "vertex"}));
  const auto pairs = indices({uint32_vec2, uint64_vec2}, "vertices at both ends");
  add(geometry, "cylinder", "cylinders",
      Parameters{kPositions, pairs, array_of("primitive.radius", {float32}, "radii"), kRadius} +
          kCaps + attributes({"primitive", "vertex"}));
  add(geometry, "cone", "truncated cones",
      Parameters{kPositions, kRadii, pairs} + kCaps + attributes({"primitive", "vertex"}));
  add(geometry, "curve", "round lines",
      Parameters{kPositions, kRadii, kRadius,
                 indices({DataType::uint32, DataType::uint64}, "first vertices of segments")} +
          attributes({"primitive", "vertex"}));
  add(geometry, "triangle", "triangles", mesh_arrays(uint32_vec3, uint64_vec3));
  add(geometry, "quad", "quadrilaterals", mesh_arrays(uint32_vec4, uint64_vec4));

  add(material, "matte", "diffuse surface",
      Parameters{field("color", {0.8f, 0.8f, 0.8f}, "diffuse colour"),
                 field("opacity", {1}, "opacity")} +
          kAlpha);
  add(material, "physicallyBased", "all by the renderer path; metal and roughness as highlights",
      Parameters{
          field("baseColor", {1, 1, 1}, "diffuse colour, or that of a metal's highlights"),
          field("opacity", {1}, "opacity"), field("metallic", {1}, "0: dielectric, 1: metal"),
          field("roughness", {1}, "0: sharp highlights, 1: none"),
          field("ior", {1.5f}, "index of refraction"),
          field("specular", {0}, "strength of a dielectric's highlights"),
          field("specularColor", {1, 1, 1}, "their colour"),
          field("emissive", {0, 0, 0}, "radiance"), field("clearcoat", {0}, "layer of lacquer"),
          field("clearcoatRoughness", {0}, "its roughness"),
          field("transmission", {0}, "refracted part of the light that is not reflected"),
          field("thickness", {0}, "0: a sheet; else a solid"),
          number("attenuationDistance", std::numeric_limits<float>::infinity(),
                 "after which light in a solid has this colour:"),
          vector("attenuationColor", {1, 1, 1}, "colour of absorption"),
          field("sheenColor", {0, 0, 0}, "light of fibres"),
          field("sheenRoughness", {0}, "its roughness")} +
          kAlpha);

  add(sampler, "image1D", "image of one row", image_sampler(array1d, 1));
  add(sampler, "image2D", "image", image_sampler(array2d, 2));
  add(sampler, "image3D", "image of three dimensions", image_sampler(array3d, 3));
  add(sampler, "primitive", "a value per primitive",
      {{"array", {array1d}, "values", {}, {}, color_types(), true},
       {"inOffset", {DataType::uint64}, "added to the number of the primitive"}});
  const Parameters image1d = image_sampler(array1d, 1);
  Parameters transform;
  for (const ParameterInfo& p : image1d)
    if (p.name == "inAttribute" || p.name == "outTransform" || p.name == "outOffset")
      transform.push_back(p);
  add(sampler, "transform", "linear function of an attribute", transform);

  add(light, "directional", "light from far away",
      kLight + Parameters{kLightDirection,
                          number("irradiance", 1, "light on a surface that faces it, W/m^2"),
                          number("angularDiameter", 0, "apparent size, radians"), kLightRadiance});
  add(light, "point", "light of a point or of a sphere",
      kLight +
          Parameters{kLightPosition, number("radius", 0, "size of the sphere"), kLightRadiance} +
          kIntensity);
  add(light, "spot", "light of a point within a cone",
      kLight + Parameters{kLightPosition, kLightDirection} + kCone + kIntensity);
  add(light, "quad", "light of a parallelogram",
      kLight +
          Parameters{kLightPosition, vector("edge1", {1, 0, 0}, "first edge"),
                     vector("edge2", {0, 1, 0}, "second edge"),
                     words("side", {"front", "back", "both"}, "sides that emit light"),
                     kLightRadiance} +
          kIntensity);
  add(light, "ring", "light of a disc or a ring",
      kLight +
          Parameters{kLightPosition, kLightDirection, number("radius", 0, "outer radius"),
                     number("innerRadius", 0, "inner radius"), kLightRadiance} +
          kCone + kIntensity);
  add(light, "hdri", "light from all sides, by an image",
      kLight + Parameters{vector("up", {0, 0, 1}, "direction of the image's upper edge"),
                          vector("direction", {1, 0, 0}, "direction of the image's centre"),
                          {"radiance", {array2d}, "the image", {}, {}, {float32_vec3}, true},
                          words("layout", {"equirectangular"}, "projection of the image"),
                          number("scale", 1, "multiplied by the image")});

  add(camera, "perspective", "pinhole, or thin lens",
      kCamera +
          Parameters{
              number("fovy", float(std::numbers::pi / 3), "vertical field of view, radians")} +
          kLens);
  add(camera, "orthographic", "parallel rays",
      kCamera + Parameters{number("height", 1, "height of the picture")});
  add(camera, "omnidirectional", "all directions",
      kCamera + Parameters{words("layout", {"equirectangular"}, "projection of the sphere")});

  const Parameters picture = {{"background",
                               {float32_vec4, array2d},
                               "colour and opacity behind everything, or an image",
                               {0, 0, 0, 1},
                               {},
                               color_types()},
                              {"pixelSamples",
                               {DataType::int32},
                               "samples per pixel of a frame; if it adds to others, 4",
                               {16},
                               {},
                               {},
                               false,
                               {1},
                               {65536}}};
  const Parameters lighting = {
      vector("ambientColor", {1, 1, 1}, "colour of the light from all sides"),
      {"ambientRadiance", {float32}, "light from all sides; without it and without lights, 1"},
      {"lights", {boolean}, "whether the lights of the world count"}};
  add(renderer, "path", "light over many bounces", picture + lighting);
  add(renderer, "default", "light from all sides, with shadows in holes, and lights",
      picture + lighting +
          Parameters{
              {"ambientSamples",
               {DataType::int32},
               "rays to the sky of each sample",
               {2},
               {},
               {},
               false,
               {1},
               {64}},
              {"ambientOcclusionDistance",
               {float32},
               "surfaces farther away hide no sky; 0: any distance",
               {0},
               {},
               {},
               false,
               {0}},
              words("look", {"application", "paper", "dark", "flat", "matte"},
                    "whose lights: the application's, or those of a look of figures"),
              {"outline", {float32}, "width of outlines, pixels", {}, {}, {}, false, {0}, {64}}});
  add(renderer, "views", "what the eye rays hit",
      picture +
          Parameters{words("view", {"normals", "depth", "ids", "materials"}, "what is shown")});

  add(frame, "", "a picture",
      {{"world", {world}, "what is shown", {}, {}, {}, true},
       {"camera", {camera}, "from where", {}, {}, {}, true},
       {"renderer", {renderer}, "and how", {}, {}, {}, true},
       {"size", {uint32_vec2}, "width and height, pixels", {}, {}, {}, true},
       {"accumulation", {boolean}, "whether frames of the same scene add their samples"},
       {"frameCompletionCallback", {frame_completion_callback}, "called when a frame is done"},
       {"frameCompletionCallbackUserData", {void_pointer}, "passed to it"},
       {"channel.color",
        {data_type},
        "type of the colours: UFIXED8_VEC4, UFIXED8_RGBA_SRGB or FLOAT32_VEC4"},
       {"channel.depth", {data_type}, "FLOAT32: distance from the eye"},
       {"channel.normal", {data_type}, "FLOAT32_VEC3 or FIXED16_VEC3"},
       {"channel.albedo", {data_type}, "UFIXED8_VEC3, UFIXED8_RGB_SRGB or FLOAT32_VEC3"},
       {"channel.primitiveId", {data_type}, "UINT32"},
       {"channel.objectId", {data_type}, "UINT32"},
       {"channel.instanceId", {data_type}, "UINT32"}});

  for (const DataType type : {array1d, array2d, array3d})
    add(type, "", "values",
        type == array1d
            ? Parameters{{"region", {uint64_region1}, "first and last element that counts"}}
            : Parameters{});
  add(surface, "", "a geometry and its material",
      {{"geometry", {geometry}, "shapes", {}, {}, {}, true},
       {"material", {material}, "appearance", {}, {}, {}, true},
       {"id", {DataType::uint32}, "number in the channel objectId"},
       {"visible", {boolean}, "whether it is drawn"}});
  add(group, "", "surfaces and lights that are placed together", kContents);
  Parameters placed = {{"group", {group}, "what is placed", {}, {}, {}, true},
                       {"transform",
                        {float32_mat4, array1d},
                        "where: one place or several",
                        kNoTransform,
                        {},
                        {float32_mat4}},
                       {"id",
                        {DataType::uint32, array1d},
                        "number in the channel instanceId",
                        {},
                        {},
                        {DataType::uint32}}};
  add(instance, "transform", "a placed group", placed + attributes({}));
  add(world, "", "everything that is shown",
      Parameters{array_of("instance", {instance}, "instances")} + kContents);

  for (ObjectInfo& info : all) {
    for (ParameterInfo& p : info.parameters) {
      for (const DataType t : p.types) info.entries.push_back({p.name.c_str(), int(t)});
      const std::vector<float>* const numbers[] = {&p.default_value, &p.minimum, &p.maximum};
      for (size_t k = 0; k < 3; ++k)
        if (!numbers[k]->empty()) p.whole[k] = int32_t(numbers[k]->front());
      if (!p.elements.empty()) p.elements.push_back(DataType::unknown);
    }
    info.entries.push_back({nullptr, 0});
  }
  return all;
}

const std::deque<ObjectInfo>& objects() {
  static const std::deque<ObjectInfo> all = make_objects();
  return all;
}

}  // namespace

const ParameterInfo* ObjectInfo::find(std::string_view name) const {
  const auto found = std::ranges::find(parameters, name, &ParameterInfo::name);
  return found == parameters.end() ? nullptr : &*found;
}

const ObjectInfo* object_info(DataType type, std::string_view subtype) {
  for (const ObjectInfo& info : objects())
    if (info.type == type && (info.subtype.empty() || info.subtype == subtype)) return &info;
  return nullptr;
}

const char** subtypes_of(DataType type) {
  static std::map<DataType, std::vector<const char*>> lists = [] {
    std::map<DataType, std::vector<const char*>> all;
    for (const ObjectInfo& info : objects())
      if (!info.subtype.empty()) all[info.type].push_back(info.subtype.c_str());
    for (auto& entry : all) entry.second.push_back(nullptr);
    return all;
  }();
  const auto found = lists.find(type);
  return found == lists.end() ? nullptr : found->second.data();
}

const void* object_property(DataType type, std::string_view subtype, std::string_view name,
                            DataType as) {
  const ObjectInfo* const info = object_info(type, subtype);
  if (!info) return nullptr;
  if (name == "description" && as == DataType::string) return info->description.c_str();
  if (name == "parameter" && as == DataType::parameter_list) return info->entries.data();
  if (name == "extension" && as == DataType::string_list)
    return static_cast<const void*>(extensions());
  static const char* channels[] = {
      "channel.color",       "channel.depth",    "channel.normal",     "channel.albedo",
      "channel.primitiveId", "channel.objectId", "channel.instanceId", nullptr};
  if (name == "channel" && as == DataType::string_list && type == DataType::frame)
    return static_cast<const void*>(channels);
  return nullptr;
}

const void* parameter_property(DataType type, std::string_view subtype, std::string_view parameter,
                               DataType parameter_type, std::string_view name, DataType as) {
  const ObjectInfo* const object = object_info(type, subtype);
  const ParameterInfo* const info = object ? object->find(parameter) : nullptr;
  if (!info || std::ranges::find(info->types, parameter_type) == info->types.end()) return nullptr;
  if (name == "description" && as == DataType::string) return info->description.c_str();
  static const uint8_t truth[] = {0, 1};
  if (name == "required" && as == boolean) return &truth[info->required];
  if (name == "value" && as == string_list)
    return info->words.empty() ? nullptr : static_cast<const void*>(info->words.data());
  if (name == "elementType" && as == data_type_list)
    return info->elements.empty() ? nullptr : info->elements.data();
  if (name == "default" && as == string && parameter_type == string)
    return info->words.empty() ? nullptr : info->words.front();
  if (as != parameter_type) return nullptr;
  const auto numbers = [&](const std::vector<float>& values, size_t k) -> const void* {
    const auto layout = layout_of(as);
    if (values.empty() || !layout || values.size() != size_t(layout->count)) return nullptr;
    if (as == DataType::int32) return &info->whole[k];
    return layout->scalar == Scalar::float32 ? values.data() : nullptr;
  };
  if (name == "default") return numbers(info->default_value, 0);
  if (name == "minimum") return numbers(info->minimum, 1);
  if (name == "maximum") return numbers(info->maximum, 2);
  return nullptr;
}

const char** extensions() {
  static const char* names[] = {"ANARI_KHR_ARRAY1D_REGION",
                                "ANARI_KHR_CAMERA_DEPTH_OF_FIELD",
                                "ANARI_KHR_CAMERA_OMNIDIRECTIONAL",
                                "ANARI_KHR_CAMERA_ORTHOGRAPHIC",
                                "ANARI_KHR_CAMERA_PERSPECTIVE",
                                "ANARI_KHR_DEVICE_SYNCHRONIZATION",
                                "ANARI_KHR_FRAME_ACCUMULATION",
                                "ANARI_KHR_FRAME_CHANNEL_ALBEDO",
                                "ANARI_KHR_FRAME_CHANNEL_INSTANCE_ID",
                                "ANARI_KHR_FRAME_CHANNEL_NORMAL",
                                "ANARI_KHR_FRAME_CHANNEL_OBJECT_ID",
                                "ANARI_KHR_FRAME_CHANNEL_PRIMITIVE_ID",
                                "ANARI_KHR_FRAME_COMPLETION_CALLBACK",
                                "ANARI_KHR_GEOMETRY_CONE",
                                "ANARI_KHR_GEOMETRY_CURVE",
                                "ANARI_KHR_GEOMETRY_CYLINDER",
                                "ANARI_KHR_GEOMETRY_QUAD",
                                "ANARI_KHR_GEOMETRY_SPHERE",
                                "ANARI_KHR_GEOMETRY_TRIANGLE",
                                "ANARI_KHR_INSTANCE_TRANSFORM",
                                "ANARI_KHR_INSTANCE_TRANSFORM_ARRAY",
                                "ANARI_KHR_LIGHT_DIRECTIONAL",
                                "ANARI_KHR_LIGHT_HDRI",
                                "ANARI_KHR_LIGHT_POINT",
                                "ANARI_KHR_LIGHT_QUAD",
                                "ANARI_KHR_LIGHT_RING",
                                "ANARI_KHR_LIGHT_SPOT",
                                "ANARI_KHR_MATERIAL_MATTE",
                                "ANARI_KHR_MATERIAL_PHYSICALLY_BASED",
                                "ANARI_KHR_RENDERER_AMBIENT_LIGHT",
                                "ANARI_KHR_RENDERER_BACKGROUND_COLOR",
                                "ANARI_KHR_RENDERER_BACKGROUND_IMAGE",
                                "ANARI_KHR_SAMPLER_IMAGE1D",
                                "ANARI_KHR_SAMPLER_IMAGE2D",
                                "ANARI_KHR_SAMPLER_IMAGE3D",
                                "ANARI_KHR_SAMPLER_PRIMITIVE",
                                "ANARI_KHR_SAMPLER_TRANSFORM",
                                nullptr};
  return names;
}

}  // namespace raio::device
