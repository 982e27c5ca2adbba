// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion::bag {

/// The kind of a record: its field `op`.
enum class Op : std::uint8_t {
  kMessage = 2,
  kFileHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// A file or a part of memory. It is read at given places, and never beyond its end.
class Bytes {
 public:
  virtual ~Bytes() = default;
  virtual std::uint64_t size() const = 0;

  /// @throws std::runtime_error if that is not inside
  void read(std::uint64_t position, std::size_t count, void* to) const;

 private:
  virtual void copy(std::uint64_t position, std::size_t count, void* to) const = 0;
};

class FileBytes : public Bytes {
 public:
  /// @throws std::runtime_error when it cannot be opened
  explicit FileBytes(const std::string& path);
  std::uint64_t size() const override { return size_; }

 private:
  void copy(std::uint64_t position, std::size_t count, void* to) const override;

  mutable std::ifstream file_;
  std::uint64_t size_ = 0;
};

class MemoryBytes : public Bytes {
 public:
  MemoryBytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  std::uint64_t size() const override { return size_; }

 private:
  void copy(std::uint64_t position, std::size_t count, void* to) const override;

  const std::uint8_t* data_;
  std::size_t size_;
};

/// `name=value` pairs, each with its length before it.
class Fields {
 public:
  /// @throws std::runtime_error if a field is longer than what holds it, or has no '='
  explicit Fields(const std::vector<std::uint8_t>& bytes);

  /// @throws std::runtime_error naming the field that is missing or has another size
  const std::string& text(const std::string& name) const;
  std::uint8_t u8(const std::string& name) const { return static_cast<std::uint8_t>(number(name, 1)); }
  std::uint32_t u32(const std::string& name) const { return static_cast<std::uint32_t>(number(name, 4)); }
  std::uint64_t u64(const std::string& name) const { return number(name, 8); }
  bool has(const std::string& name) const { return values_.count(name) > 0; }

 private:
  std::uint64_t number(const std::string& name, std::size_t size) const;

  std::map<std::string, std::string> values_;
};

/// A record's header, and where its data are.
struct Record {
  Fields fields;
  std::uint64_t data_begin;
  std::uint32_t data_size;

  Op op() const { return static_cast<Op>(fields.u8("op")); }
  std::uint64_t end() const { return data_begin + data_size; }
};

/// @param end  where the record has to end at the latest
/// @throws std::runtime_error naming what is wrong, and where
Record readRecord(const Bytes& bytes, std::uint64_t position, std::uint64_t end);

/// The same, of a given kind.
Record readRecord(const Bytes& bytes, std::uint64_t position, std::uint64_t end, Op op);

/// @throws std::runtime_error for more than `limit` bytes
std::vector<std::uint8_t> readData(const Bytes& bytes, const Record& record, std::size_t limit);

/// Little-endian, as all numbers in a bag.
std::uint64_t littleEndian(const std::uint8_t* bytes, std::size_t count);

/// [ns] of seconds and nanoseconds, of 32 bits each.
Stamp timeOf(std::uint64_t time);

/// Memory that is not touched before it is used. (A vector's is, when it is made.)
struct Buffer {
  std::unique_ptr<std::uint8_t[]> data;
  std::size_t size = 0;
};

/// @param compression  as a chunk's header names it: lz4 or bz2
/// @param size         [bytes] that come out
/// @throws std::runtime_error if the data are damaged, or give another size
Buffer decompress(const std::string& compression, const std::vector<std::uint8_t>& data, std::uint32_t size);

}  // namespace rgbd_sfm_fusion::bag
