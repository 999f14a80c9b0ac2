#include <tactus/report/files.hpp>
#include <tactus/telemetry/export.hpp>
#include <tactus/telemetry/export_parts.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include <hdf5.h>

namespace tactus::telemetry {

namespace {

/// An HDF5 object, closed by the function that its kind asks for.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closer)(hid_t)) : id_(id), close_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] bool ok() const { return id_ >= 0; }
  /// Closes now, for an error that only shows then.
  bool close() {
    const bool done = id_ >= 0 && close_(id_) >= 0;
    id_ = H5I_INVALID_HID;
    return done;
  }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// A text of fixed length, the empty one as a single null. Called UTF-8 only where it is more than ASCII: HDF5 converts
/// between the two names for the same bytes in neither direction, and Octave reads into ASCII.
Handle text_type(const std::string& content) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), content.empty() ? 1 : content.size());
  const bool ascii =
      std::all_of(content.begin(), content.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  H5Tset_cset(type.get(), ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  return type;
}

bool add_attribute(hid_t object, const char* name, const std::string& content) {
  const Handle type = text_type(content);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.ok() && H5Awrite(attribute.get(), type.get(), content.c_str()) >= 0;
}

bool add_text(hid_t group, const std::string& name, const std::string& content) {
  const Handle type = text_type(content);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle set(H5Dcreate2(group, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                   H5Dclose);
  return set.ok() && H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, content.c_str()) >= 0;
}

bool add_column(hid_t group, const Column& column, const std::vector<double>& values) {
  const hsize_t rows = values.size();
  const Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  const Handle set(
      H5Dcreate2(group, column.name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  return set.ok() && H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0 &&
         add_attribute(set.get(), "unit", column.unit) && add_attribute(set.get(), "site", column.site) &&
         add_attribute(set.get(), "frame", column.frame) && add_attribute(set.get(), "sign", column.sign);
}

Handle make_group(hid_t file, const std::string& name) {
  return {H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

}  // namespace

Check export_hdf5(const LogContent& content, const std::filesystem::path& file) {
  if (auto error = refuse_empty(content, file)) return error;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are told by us
  return report::replace_file(file, [&content](const std::string& temporary) {
    Handle hdf(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    bool done = hdf.ok();
    for (const LogTable& original : content.tables) {
      const LogTable table = with_time(original);
      const Handle group = make_group(hdf.get(), identifier_of(table.topic));
      done = done && group.ok();
      for (std::size_t i = 0; done && i < table.columns.size(); ++i) {
        done = add_column(group.get(), table.columns[i], table.values[i]);
      }
    }
    if (const auto run = about(content.summary); done && !run.empty()) {
      const Handle group = make_group(hdf.get(), "about");
      done = group.ok();
      for (const auto& [key, value] : run) done = done && add_text(group.get(), key, value);
    }
    return hdf.close() && done;
  });
}

}  // namespace tactus::telemetry
