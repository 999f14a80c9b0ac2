#include <tactus/stability/map_hdf5.hpp>

#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <hdf5.h>

namespace tactus::stability {

namespace {

/// An HDF5 identifier that is closed when it goes.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] bool ok() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

bool write_text(hid_t object, const char* name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  if (H5Tset_size(type.get(), text.size() + 1) < 0) return false;
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.ok() && H5Awrite(attribute.get(), type.get(), text.c_str()) >= 0;
}

/// H5S_ALL without the cast in its definition.
constexpr hid_t everything = 0;

/// How objects are made: without the time of day, so that equal maps give equal bytes.
Handle timeless(hid_t kind) {
  const hid_t list = H5Pcreate(kind);
  if (list >= 0) H5Pset_obj_track_times(list, false);
  return {list, H5Pclose};
}

/// `words` only where there are some.
bool write_numbers(hid_t place, const std::string& name, const std::vector<hsize_t>& shape,
                   const std::vector<double>& numbers, const std::string& unit, const std::string& words) {
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Handle how = timeless(H5P_DATASET_CREATE);
  const Handle set(H5Dcreate2(place, name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, how.get(), H5P_DEFAULT),
                   H5Dclose);
  return set.ok() && H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, everything, everything, H5P_DEFAULT, numbers.data()) >= 0 &&
         write_text(set.get(), "unit", unit) && (words.empty() || write_text(set.get(), "words", words));
}

bool write_all(const std::string& path, const MapResult& map) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are returned and not printed
  const Handle how_file = timeless(H5P_FILE_CREATE), how_group = timeless(H5P_GROUP_CREATE);
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, how_file.get(), H5P_DEFAULT), H5Fclose);
  if (!file.ok()) return false;
  const Handle axes(H5Gcreate2(file.get(), "axes", H5P_DEFAULT, how_group.get(), H5P_DEFAULT), H5Gclose);
  if (!axes.ok()) return false;
  std::vector<hsize_t> shape;
  for (const MapAxis& axis : map.axes) {
    std::string words;
    for (const std::string& word : axis.words) words += (words.empty() ? "" : ",") + word;
    if (!write_numbers(axes.get(), std::to_string(shape.size()) + "-" + axis.key, {axis.values.size()}, axis.values,
                       axis.unit, words)) {
      return false;
    }
    shape.push_back(axis.values.size());
  }
  const auto column = [&](const char* name, const char* unit, const char* words, auto&& value_of) {
    std::vector<double> numbers;
    numbers.reserve(map.points.size());
    for (const PointResult& point : map.points) numbers.push_back(value_of(point));
    return write_numbers(file.get(), name, shape, numbers, unit, words);
  };
  return column("verdict", "", "0 settled, 1 ringing, 2 limit-cycle, 3 diverged",
                [](const PointResult& p) { return static_cast<double>(p.verdict); }) &&
         column("settling_time", "s", "", [](const PointResult& p) { return p.settling_time_s; }) &&
         column("contacts", "", "", [](const PointResult& p) { return p.contacts; }) &&
         column("peak_force", "N", "", [](const PointResult& p) { return p.peak_force_N; }) &&
         column("residual_rms", "N", "", [](const PointResult& p) { return p.residual_rms_N; }) &&
         H5Fflush(file.get(), H5F_SCOPE_GLOBAL) >= 0;
}

}  // namespace

Check write_hdf5(const std::filesystem::path& path, const MapResult& map) {
  const std::filesystem::path beside = path.string() + ".part";
  const bool written = write_all(beside.string(), map);
  std::error_code error;
  if (written) std::filesystem::rename(beside, path, error);
  if (written && !error) return {};
  std::error_code ignored;
  std::filesystem::remove(beside, ignored);
  return Error{.code = ErrorCode::unwritable,
               .parameter = {},
               .message = "the map could not be written as HDF5: give --out a place with room",
               .place = path.string()};
}

}  // namespace tactus::stability
