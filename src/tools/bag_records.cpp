// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_records.h"

#include <algorithm>
#include <cstring>

namespace rgbd_sfm_fusion::bag {
namespace {

constexpr std::size_t kLargestHeader = 1U << 20U;

std::runtime_error damagedAt(std::uint64_t position, const std::string& reason) {
  return std::runtime_error("record at byte " + std::to_string(position) + ": " + reason);
}

std::uint32_t readU32(const Bytes& bytes, std::uint64_t position) {
  std::uint8_t raw[4];
  bytes.read(position, sizeof raw, raw);
  return static_cast<std::uint32_t>(littleEndian(raw, sizeof raw));
}

}  // namespace

void Bytes::read(std::uint64_t position, std::size_t count, void* to) const {
  if (position > size() || count > size() - position)
    throw std::runtime_error("it ends before byte " + std::to_string(position + count));
  if (count > 0) copy(position, count, to);
}

FileBytes::FileBytes(const std::string& path) : file_(path, std::ios::binary | std::ios::ate) {
  if (!file_) throw std::runtime_error("cannot be opened");
  size_ = static_cast<std::uint64_t>(file_.tellg());
}

void FileBytes::copy(std::uint64_t position, std::size_t count, void* to) const {
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position));
  file_.read(static_cast<char*>(to), static_cast<std::streamsize>(count));
  if (!file_) throw std::runtime_error("cannot be read at byte " + std::to_string(position));
}

void MemoryBytes::copy(std::uint64_t position, std::size_t count, void* to) const {
  std::memcpy(to, data_ + position, count);
}

Fields::Fields(const std::vector<std::uint8_t>& bytes) {
  std::size_t at = 0;
  while (at < bytes.size()) {
    if (bytes.size() - at < 4) throw std::runtime_error("a field's length is cut off");
    const std::uint64_t length = littleEndian(bytes.data() + at, 4);
    at += 4;
    if (length > bytes.size() - at) throw std::runtime_error("a field is longer than its header");
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    const auto equals = std::find(begin, end, static_cast<std::uint8_t>('='));
    if (equals == end) throw std::runtime_error("a field is no 'name=value'");
    values_[std::string(begin, equals)] = std::string(equals + 1, end);
    at += length;
  }
}

const std::string& Fields::text(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) throw std::runtime_error("has no field '" + name + "'");
  return found->second;
}

std::uint64_t Fields::number(const std::string& name, std::size_t size) const {
  const std::string& value = text(name);
  if (value.size() != size)
    throw std::runtime_error("field '" + name + "' has " + std::to_string(value.size()) +
                             " bytes, expected " + std::to_string(size));
  return littleEndian(reinterpret_cast<const std::uint8_t*>(value.data()), size);
}

Record readRecord(const Bytes& bytes, std::uint64_t position, std::uint64_t end) {
  try {
    const auto require = [&](std::uint64_t from, std::uint64_t count) {
      if (from > end || count > end - from) throw std::runtime_error("is longer than what holds it");
    };
    require(position, 4);
    const std::uint32_t header_size = readU32(bytes, position);
    if (header_size > kLargestHeader)
      throw std::runtime_error("claims a header of " + std::to_string(header_size) + " bytes");
    require(position + 4, header_size + 4ULL);
    std::vector<std::uint8_t> header(header_size);
    bytes.read(position + 4, header_size, header.data());
    const std::uint64_t data_begin = position + 8 + header_size;
    const std::uint32_t data_size = readU32(bytes, data_begin - 4);
    require(data_begin, data_size);
    return {Fields(header), data_begin, data_size};
  } catch (const std::runtime_error& error) {
    throw damagedAt(position, error.what());
  }
}

Record readRecord(const Bytes& bytes, std::uint64_t position, std::uint64_t end, Op op) {
  Record record = readRecord(bytes, position, end);
  try {
    if (record.op() != op)
      throw std::runtime_error("is of kind " + std::to_string(static_cast<int>(record.op())) + ", expected " +
                               std::to_string(static_cast<int>(op)));
  } catch (const std::runtime_error& error) {
    throw damagedAt(position, error.what());
  }
  return record;
}

std::vector<std::uint8_t> readData(const Bytes& bytes, const Record& record, std::size_t limit) {
  if (record.data_size > limit)
    throw damagedAt(record.data_begin, "claims " + std::to_string(record.data_size) +
                                           " bytes, expected at most " + std::to_string(limit));
  std::vector<std::uint8_t> data(record.data_size);
  bytes.read(record.data_begin, data.size(), data.data());
  return data;
}

std::uint64_t littleEndian(const std::uint8_t* bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i > 0; --i) value = value << 8U | bytes[i - 1];
  return value;
}

Stamp timeOf(std::uint64_t time) {
  constexpr Stamp kSecond = 1'000'000'000;
  return static_cast<Stamp>(time & 0xFFFFFFFFU) * kSecond + static_cast<Stamp>(time >> 32U);
}

}  // namespace rgbd_sfm_fusion::bag
