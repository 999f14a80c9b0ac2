// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/report/hdf5_file.hpp>

#include <algorithm>
#include <utility>

#include <hdf5.h>

namespace tactus::report {

/// An HDF5 object, closed by the function that its kind asks for.
class Hdf5File::Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] bool ok() const { return id_ >= 0; }

  /// How objects of a kind are made: without the time of day.
  static Handle timeless(hid_t kind) {
    Handle list(H5Pcreate(kind), H5Pclose);
    H5Pset_obj_track_times(list.get(), false);
    return list;
  }
  /// How a path is linked: with the groups that it needs.
  static Handle with_groups() {
    Handle list(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(list.get(), 1);
    return list;
  }
  /// A text of fixed length, the empty one as a single null. Called UTF-8 only where it is more than ASCII: HDF5
  /// converts between the two names for the same bytes in neither direction, and Octave reads into ASCII.
  static Handle text_type(const std::string& content) {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), content.empty() ? 1 : content.size());
    const bool ascii =
        std::all_of(content.begin(), content.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
    H5Tset_cset(type.get(), ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
    H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
    return type;
  }

  [[nodiscard]] bool add_attribute(const std::string& name, const std::string& content) const {
    const Handle type = text_type(content), space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(H5Acreate2(id_, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    return attribute.ok() && H5Awrite(attribute.get(), type.get(), content.c_str()) >= 0;
  }
  [[nodiscard]] Handle add_set(const std::string& path, const Handle& type, const Handle& space) const {
    const Handle link = with_groups(), how = timeless(H5P_DATASET_CREATE);
    return {H5Dcreate2(id_, path.c_str(), type.get(), space.get(), link.get(), how.get(), H5P_DEFAULT), H5Dclose};
  }

 private:
  hid_t id_;
  Close close_;
};

namespace {

/// H5S_ALL without the cast in its definition.
constexpr hid_t everything = 0;
constexpr std::size_t memory_step_bytes = std::size_t{1} << 20;

}  // namespace

// On a disk that fills up HDF5 cannot close its own file any more, and stumbles over it at the program's end.
Hdf5File::Hdf5File() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are told by us
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), how = Handle::timeless(H5P_FILE_CREATE);
  H5Pset_fapl_core(access.get(), memory_step_bytes, false);
  file_ = std::make_unique<Handle>(H5Fcreate("in memory", H5F_ACC_TRUNC, how.get(), access.get()), H5Fclose);
  sound_ = file_->ok();
}

Hdf5File::~Hdf5File() = default;

void Hdf5File::add_numbers(const std::string& path, std::span<const std::size_t> shape, std::span<const double> numbers,
                           const Attributes& attributes) {
  const std::vector<hsize_t> sizes(shape.begin(), shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose);
  const Handle type(H5Tcopy(H5T_IEEE_F64LE), H5Tclose), set = file_->add_set(path, type, space);
  sound_ = sound_ && set.ok() &&
           H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, everything, everything, H5P_DEFAULT, numbers.data()) >= 0;
  for (const auto& [name, content] : attributes) sound_ = sound_ && set.add_attribute(name, content);
}

void Hdf5File::describe_group(const std::string& path, const Attributes& attributes) {
  const Handle group(H5Gopen2(file_->get(), path.c_str(), H5P_DEFAULT), H5Gclose);
  sound_ = sound_ && group.ok();
  for (const auto& [name, content] : attributes) sound_ = sound_ && group.add_attribute(name, content);
}

void Hdf5File::add_text(const std::string& path, const std::string& content) {
  const Handle type = Handle::text_type(content), space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle set = file_->add_set(path, type, space);
  sound_ =
      sound_ && set.ok() && H5Dwrite(set.get(), type.get(), everything, everything, H5P_DEFAULT, content.c_str()) >= 0;
}

Check Hdf5File::write(const std::filesystem::path& file) const {
  std::string image;
  bool sound = sound_ && H5Fflush(file_->get(), H5F_SCOPE_GLOBAL) >= 0;
  if (sound) {
    const ssize_t size = H5Fget_file_image(file_->get(), nullptr, 0);
    if (size > 0) image.resize(static_cast<std::size_t>(size));
    sound = size > 0 && H5Fget_file_image(file_->get(), image.data(), image.size()) == size;
  }
  if (!sound) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "HDF5 could not put the file together in memory: free some, or write less at once",
                 .place = file.string()};
  }
  return write_file(file, image);
}

}  // namespace tactus::report
