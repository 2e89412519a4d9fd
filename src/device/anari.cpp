// The layer that speaks ANARI: a shared library that applications load by the name `raio`. It
// passes every call to the objects of this room.
#include <anari/backend/DeviceImpl.h>
#include <anari/backend/LibraryImpl.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>

#include "device/frame.h"
#include "device/objects.h"
#include "device/parameters.h"
#include "device/world.h"

namespace raio::device {

namespace {

static_assert(int(DataType::float32_vec3) == ANARI_FLOAT32_VEC3 &&
              int(DataType::world) == ANARI_WORLD &&
              int(DataType::ufixed8_rgba_srgb) == ANARI_UFIXED8_RGBA_SRGB &&
              int(DataType::float32_mat4) == ANARI_FLOAT32_MAT4 &&
              int(DataType::uint64_region1) == ANARI_UINT64_REGION1 &&
              int(DataType::frame_completion_callback) == ANARI_FRAME_COMPLETION_CALLBACK &&
              int(Severity::debug) == ANARI_SEVERITY_DEBUG &&
              int(Status::out_of_memory) == ANARI_STATUS_OUT_OF_MEMORY);
static_assert(sizeof(ParameterEntry) == sizeof(ANARIParameter) &&
              offsetof(ParameterEntry, type) == offsetof(ANARIParameter, type));

DataType type_of(ANARIDataType type) { return DataType(int(type)); }
ANARIDataType anari_type(DataType type) { return ANARIDataType(int(type)); }

std::string_view text(const char* s) { return s ? s : ""; }

class AnariDevice final : public anari::DeviceImpl {
 public:
  explicit AnariDevice(ANARILibrary library)
      : DeviceImpl(library), device_([this](const Device::Message& m) { pass_on(m); }) {
    self_ = device_.create(DataType::device, "");
  }

  ANARIArray1D newArray1D(const void* memory, ANARIMemoryDeleter deleter, const void* user,
                          ANARIDataType type, uint64_t n) override {
    return made<ANARIArray1D>(new_array(DataType::array1d, memory, deleter, user, type, {n, 1, 1}));
  }
  ANARIArray2D newArray2D(const void* memory, ANARIMemoryDeleter deleter, const void* user,
                          ANARIDataType type, uint64_t n1, uint64_t n2) override {
    return made<ANARIArray2D>(
        new_array(DataType::array2d, memory, deleter, user, type, {n1, n2, 1}));
  }
  ANARIArray3D newArray3D(const void* memory, ANARIMemoryDeleter deleter, const void* user,
                          ANARIDataType type, uint64_t n1, uint64_t n2, uint64_t n3) override {
    return made<ANARIArray3D>(
        new_array(DataType::array3d, memory, deleter, user, type, {n1, n2, n3}));
  }
  ANARIGeometry newGeometry(const char* subtype) override {
    return made<ANARIGeometry>(create(DataType::geometry, subtype));
  }
  ANARIMaterial newMaterial(const char* subtype) override {
    return made<ANARIMaterial>(create(DataType::material, subtype));
  }
  ANARISampler newSampler(const char* subtype) override {
    return made<ANARISampler>(create(DataType::sampler, subtype));
  }
  ANARISurface newSurface() override { return made<ANARISurface>(create(DataType::surface, "")); }
  ANARISpatialField newSpatialField(const char* subtype) override {
    return made<ANARISpatialField>(create(DataType::spatial_field, subtype));
  }
  ANARIVolume newVolume(const char* subtype) override {
    return made<ANARIVolume>(create(DataType::volume, subtype));
  }
  ANARILight newLight(const char* subtype) override {
    return made<ANARILight>(create(DataType::light, subtype));
  }
  ANARIGroup newGroup() override { return made<ANARIGroup>(create(DataType::group, "")); }
  ANARIInstance newInstance(const char* subtype) override {
    return made<ANARIInstance>(create(DataType::instance, subtype));
  }
  ANARIWorld newWorld() override { return made<ANARIWorld>(create(DataType::world, "")); }
  ANARICamera newCamera(const char* subtype) override {
    return made<ANARICamera>(create(DataType::camera, subtype));
  }
  ANARIRenderer newRenderer(const char* subtype) override {
    return made<ANARIRenderer>(create(DataType::renderer, subtype));
  }
  ANARIFrame newFrame() override { return made<ANARIFrame>(create(DataType::frame, "")); }

  void setParameter(ANARIObject object, const char* name, ANARIDataType type,
                    const void* value) override {
    guarded([&] { device_.set(handle(object), text(name), type_of(type), value); });
  }
  void unsetParameter(ANARIObject object, const char* name) override {
    guarded([&] { device_.unset(handle(object), text(name)); });
  }
  void unsetAllParameters(ANARIObject object) override {
    guarded([&] { device_.unset_all(handle(object)); });
  }
  void* mapParameterArray1D(ANARIObject object, const char* name, ANARIDataType type, uint64_t n,
                            uint64_t* stride) override {
    return map_parameter(object, name, DataType::array1d, type, {n, 1, 1}, stride);
  }
  void* mapParameterArray2D(ANARIObject object, const char* name, ANARIDataType type, uint64_t n1,
                            uint64_t n2, uint64_t* stride) override {
    return map_parameter(object, name, DataType::array2d, type, {n1, n2, 1}, stride);
  }
  void* mapParameterArray3D(ANARIObject object, const char* name, ANARIDataType type, uint64_t n1,
                            uint64_t n2, uint64_t n3, uint64_t* stride) override {
    return map_parameter(object, name, DataType::array3d, type, {n1, n2, n3}, stride);
  }
  void unmapParameterArray(ANARIObject object, const char* name) override {
    guarded([&] { device_.unmap_parameter(handle(object), text(name)); });
  }
  void commitParameters(ANARIObject object) override {
    guarded([&] { device_.commit(handle(object)); });
  }
  void* mapArray(ANARIArray array) override {
    void* memory = nullptr;
    guarded([&] { memory = device_.map(array); });
    return memory;
  }
  void unmapArray(ANARIArray array) override {
    guarded([&] { device_.unmap(array); });
  }
  void retain(ANARIObject object) override {
    if (is_self(object))
      ++references_;
    else
      guarded([&] { device_.retain(object); });
  }
  void release(ANARIObject object) override {
    if (!is_self(object))
      guarded([&] { device_.release(object); });
    else if (--references_ == 0)
      delete this;
  }

  int getProperty(ANARIObject object, const char* name, ANARIDataType type, void* memory,
                  uint64_t size, ANARIWaitMask mask) override {
    int found = 0;
    guarded([&] {
      found = is_self(object) ? own_property(text(name), type, memory, size)
                              : property(object, text(name), type, memory, size, mask);
    });
    return found;
  }

  const char** getObjectSubtypes(ANARIDataType type) override { return subtypes_of(type_of(type)); }
  const void* getObjectInfo(ANARIDataType type, const char* subtype, const char* name,
                            ANARIDataType info_type) override {
    return object_property(type_of(type), text(subtype), text(name), type_of(info_type));
  }
  const void* getParameterInfo(ANARIDataType type, const char* subtype, const char* parameter,
                               ANARIDataType parameter_type, const char* name,
                               ANARIDataType info_type) override {
    return parameter_property(type_of(type), text(subtype), text(parameter),
                              type_of(parameter_type), text(name), type_of(info_type));
  }

  const void* frameBufferMap(ANARIFrame frame, const char* channel, uint32_t* width,
                             uint32_t* height, ANARIDataType* type) override {
    const void* pixels = nullptr;
    DataType found = DataType::unknown;
    *width = *height = 0;
    guarded([&] {
      if (const auto f = device_.find<Frame>(frame, "a frame to map"))
        pixels = f->map(text(channel), width, height, &found);
    });
    *type = anari_type(found);
    return pixels;
  }
  void frameBufferUnmap(ANARIFrame, const char*) override {}
  void renderFrame(ANARIFrame frame) override {
    guarded([&] {
      const auto f = device_.find<Frame>(frame, "a frame to render");
      if (!f) return;
      std::unique_lock lock(device_.mutex());
      const Value* const callback = f->find("frameCompletionCallback");
      const auto call = callback ? callback->as<ANARIFrameCompletionCallback>() : nullptr;
      const Value* const data = f->find("frameCompletionCallbackUserData");
      const void* const user = data ? data->as<const void*>() : nullptr;
      lock.unlock();
      f->render([=, this] {
        if (call) call(user, this_device(), frame);
      });
    });
  }
  int frameReady(ANARIFrame frame, ANARIWaitMask mask) override {
    int ready = 0;
    guarded([&] {
      if (const auto f = device_.find<Frame>(frame, "a frame"))
        ready = f->ready(mask == ANARI_WAIT);
    });
    return ready;
  }
  void discardFrame(ANARIFrame frame) override {
    guarded([&] {
      if (const auto f = device_.find<Frame>(frame, "a frame to discard")) f->discard();
    });
  }

 private:
  template <class Handle>
  static Handle made(Object* object) {
    return reinterpret_cast<Handle>(object);
  }
  bool is_self(ANARIObject object) const {
    return static_cast<const void*>(object) == static_cast<const void*>(this_device());
  }
  const void* handle(ANARIObject object) const {
    return is_self(object) ? static_cast<const void*>(self_) : object;
  }

  // No exception may reach C.
  template <class F>
  void guarded(const F& call) {
    try {
      call();
    } catch (const std::bad_alloc&) {
      device_.report(nullptr, Severity::error, Status::out_of_memory, "out of memory");
    } catch (const std::exception& error) {
      device_.report(nullptr, Severity::error, Status::unknown_error, error.what());
    }
  }

  Object* create(DataType type, const char* subtype) {
    Object* object = nullptr;
    guarded([&] { object = device_.create(type, text(subtype)); });
    return object;
  }
  Object* new_array(DataType type, const void* memory, ANARIMemoryDeleter deleter, const void* user,
                    ANARIDataType element, std::array<uint64_t, 3> size) {
    Object* array = nullptr;
    guarded(
        [&] { array = device_.create_array(type, memory, deleter, user, type_of(element), size); });
    return array;
  }
  void* map_parameter(ANARIObject object, const char* name, DataType type, ANARIDataType element,
                      std::array<uint64_t, 3> size, uint64_t* stride) {
    void* memory = nullptr;
    guarded([&] {
      memory =
          device_.map_parameter(handle(object), text(name), type, type_of(element), size, stride);
    });
    return memory;
  }

  // To the callback that the application set, or else the library's.
  void pass_on(const Device::Message& m) {
    ANARIStatusCallback callback = defaultStatusCallback();
    const void* user = defaultStatusCallbackUserPtr();
    if (self_) {
      if (const Value* const own = self_->find("statusCallback"))
        callback = own->as<ANARIStatusCallback>();
      if (const Value* const data = self_->find("statusCallbackUserData"))
        user = data->as<const void*>();
    }
    if (!callback) return;
    const auto source = m.source ? made<ANARIObject>(const_cast<Object*>(m.source))
                                 : static_cast<ANARIObject>(this_device());
    callback(user, this_device(), source, anari_type(m.source_type),
             ANARIStatusSeverity(m.severity), ANARIStatusCode(m.status), m.text.c_str());
  }

  template <class T>
  static int put(const T& value, void* memory, uint64_t size) {
    if (size < sizeof(T)) return 0;
    std::memcpy(memory, static_cast<const void*>(&value), sizeof(T));
    return 1;
  }
  static int put_text(const std::string& value, ANARIDataType type, bool length, void* memory,
                      uint64_t size) {
    if (length) return type == ANARI_UINT64 ? put(uint64_t(value.size() + 1), memory, size) : 0;
    if (type != ANARI_STRING || size == 0) return 0;
    const size_t copied = std::min<size_t>(value.size(), size - 1);
    std::memcpy(memory, value.data(), copied);
    static_cast<char*>(memory)[copied] = 0;
    return 1;
  }

  static int own_property(std::string_view name, ANARIDataType type, void* memory, uint64_t size) {
    int version[3] = {};
    std::sscanf(raio::version().c_str(), "%d.%d.%d", &version[0], &version[1], &version[2]);
    if (name == "version.name" || name == "version.name.size")
      return put_text("Raio " + raio::version(), type, name.ends_with(".size"), memory, size);
    if (name == "extension" && type == ANARI_STRING_LIST) return put(extensions(), memory, size);
    if (name == "geometryMaxIndex" && type == ANARI_UINT64)
      return put(uint64_t(0xfffffffe), memory, size);
    if (type != ANARI_INT32) return 0;
    if (name == "version")
      return put(version[0] * 10000 + version[1] * 100 + version[2], memory, size);
    if (name == "version.major") return put(version[0], memory, size);
    if (name == "version.minor") return put(version[1], memory, size);
    if (name == "version.patch") return put(version[2], memory, size);
    return 0;
  }
  int property(ANARIObject object, std::string_view name, ANARIDataType type, void* memory,
               uint64_t size, ANARIWaitMask mask) {
    const auto found = device_.find(object, "an object with properties");
    if (!found) return 0;
    if (const auto frame = std::dynamic_pointer_cast<Frame>(found);
        frame && type == ANARI_FLOAT32) {
      if (name == "renderProgress" || name == "refinementProgress")
        return put(frame->progress(), memory, size);
      if (name != "duration" || (!frame->ready(mask == ANARI_WAIT))) return 0;
      return put(frame->duration(), memory, size);
    }
    const bool bounded = found->type == DataType::world || found->type == DataType::group ||
                         found->type == DataType::instance;
    if (bounded && name == "bounds" && type == ANARI_FLOAT32_BOX3) {
      const std::lock_guard lock(device_.mutex());
      const auto box = bounds_of(*found);
      return box ? put(*box, memory, size) : 0;
    }
    if (found->type == DataType::renderer && name == "extension" && type == ANARI_STRING_LIST)
      return put(extensions(), memory, size);
    return 0;
  }

  int references_ = 1;
  Device device_;
  Object* self_ = nullptr;  // the device's own parameters
};

class AnariLibrary final : public anari::LibraryImpl {
 public:
  using LibraryImpl::LibraryImpl;
  ANARIDevice newDevice(const char*) override {
    return reinterpret_cast<ANARIDevice>(new AnariDevice(this_library()));
  }
  const char** getDeviceExtensions(const char*) override { return extensions(); }
};

}  // namespace

}  // namespace raio::device

extern "C" RAIO_API ANARI_DEFINE_LIBRARY_ENTRYPOINT(raio, handle, callback, user) {
  return reinterpret_cast<ANARILibrary>(new raio::device::AnariLibrary(handle, callback, user));
}
