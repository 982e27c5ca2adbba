// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/bag_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "bag_records.h"

namespace rgbd_sfm_fusion {
namespace {

namespace fs = std::filesystem;
using bag::Op;

const std::string kMagic = "#ROSBAG V2.0\n";
// The first record is padded, so that the place of the index can be written into it at the end.
constexpr std::size_t kEndOfFirstRecord = 4117;
constexpr std::size_t kLargestConnection = 16U << 20U;  // [bytes] of its record, with its type's definition
constexpr std::size_t kLargestMessage = 1U << 30U;      // [bytes] as roscpp sends at most
constexpr std::size_t kMostCached = 128U << 20U;        // [bytes] of chunks that may be asked for again

bool isActive(const std::string& path) {
  const std::string ending = ".active";
  return path.size() >= ending.size() &&
         path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
}

std::runtime_error notClosed(const std::string& path) {
  const std::string what =
      isActive(path) ? "is a recording that was cut off" : "was not closed, or is cut off";
  return std::runtime_error(path + ": " + what + ", and has no index: 'rosbag reindex " + path +
                            "' gives it one" +
                            (isActive(path) ? "; then rename it to " + path.substr(0, path.size() - 7) : ""));
}

/// If a file is no bag, says what it is instead.
void requireFile(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    const std::string active = path + ".active";
    throw std::runtime_error(path + ": there is no such file" +
                             (fs::exists(active, error)
                                  ? "; there is " + active +
                                        ", a recording that goes on or was cut off ('rosbag "
                                        "reindex' makes a bag of it)"
                                  : ""));
  }
  if (status.type() == fs::file_type::none) throw std::runtime_error(path + ": " + error.message());
  if (status.type() == fs::file_type::directory)
    throw std::runtime_error(path + ": is a folder, expected a bag");
  if (status.type() != fs::file_type::regular)
    throw std::runtime_error(path +
                             ": is a device or a pipe, expected a file, as a bag is not read in order");
  errno = 0;
  if (!std::ifstream(path, std::ios::binary)) throw std::runtime_error(path + ": " + std::strerror(errno));
}

void requireMagic(const std::string& path, const bag::Bytes& bytes) {
  if (bytes.size() == 0) {
    throw std::runtime_error(path + (isActive(path)
                                         ? ": is empty: the recording was cut off before anything came"
                                         : ": is empty, expected a bag"));
  }
  std::string start(std::min<std::uint64_t>(kMagic.size(), bytes.size()), '\0');
  bytes.read(0, start.size(), start.data());
  if (start == kMagic) return;
  if (start.rfind("#ROS", 0) == 0 && start != kMagic.substr(0, start.size())) {
    throw std::runtime_error(path + ": is a bag of another format (" + start.substr(0, start.find('\n')) +
                             "), expected " + kMagic.substr(1, kMagic.size() - 2) +
                             ": 'rosbag fix' can convert it");
  }
  throw std::runtime_error(path + ": is no bag: it does not start with '" +
                           kMagic.substr(0, kMagic.size() - 1) + "'");
}

}  // namespace

/// The data of chunks, decompressed if they are compressed.
class BagFile::Chunks {
 public:
  explicit Chunks(const std::string& path) : file_(path) {}

  const bag::FileBytes& file() const { return file_; }

  /// @return where the chunk ends
  std::uint64_t add(std::uint64_t position) {
    const bag::Record record = bag::readRecord(file_, position, file_.size(), Op::kChunk);
    chunks_.push_back({position, record.data_begin, record.data_size, record.fields.u32("size"),
                       record.fields.text("compression")});
    const Chunk& chunk = chunks_.back();
    if (!chunk.isCompressed() && chunk.size != chunk.data_size) {
      throw std::runtime_error("chunk at byte " + std::to_string(position) +
                               ": is uncompressed, but claims " + std::to_string(chunk.size) +
                               " bytes and has " + std::to_string(chunk.data_size));
    }
    return record.end();
  }

  std::size_t size() const { return chunks_.size(); }

  std::vector<std::uint8_t> read(std::uint32_t index, std::uint32_t offset, std::uint32_t connection) {
    const Chunk& chunk = chunks_.at(index);
    try {
      if (!chunk.isCompressed())
        return readMessage(file_, chunk.data_begin + offset, chunk.data_begin + chunk.data_size, connection);
      const bag::Buffer& data = decompressed(index);
      return readMessage(bag::MemoryBytes(data.data.get(), data.size), offset, data.size, connection);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error("chunk at byte " + std::to_string(chunk.position) + ": " + error.what());
    }
  }

 private:
  struct Chunk {
    std::uint64_t position;
    std::uint64_t data_begin;
    std::uint32_t data_size;
    std::uint32_t size;
    std::string compression;

    bool isCompressed() const { return compression != "none"; }
  };

  static std::vector<std::uint8_t> readMessage(const bag::Bytes& bytes, std::uint64_t position,
                                               std::uint64_t end, std::uint32_t connection) {
    bag::Record record = bag::readRecord(bytes, position, end);
    while (record.op() == Op::kConnection) record = bag::readRecord(bytes, record.end(), end);
    if (record.op() != Op::kMessage || record.fields.u32("conn") != connection)
      throw std::runtime_error("the index does not point at a message of its connection");
    return bag::readData(bytes, record, kLargestMessage);
  }

  const bag::Buffer& decompressed(std::uint32_t index) {
    for (const auto& [cached, data] : cache_) {
      if (cached == index) return data;
    }
    const Chunk& chunk = chunks_[index];
    std::vector<std::uint8_t> packed(chunk.data_size);
    file_.read(chunk.data_begin, packed.size(), packed.data());
    std::size_t cached_bytes = chunk.size;
    for (const auto& [cached, data] : cache_) cached_bytes += data.size;
    for (; !cache_.empty() && cached_bytes > kMostCached; cache_.pop_front())
      cached_bytes -= cache_.front().second.size;
    return cache_.emplace_back(index, bag::decompress(chunk.compression, packed, chunk.size)).second;
  }

  bag::FileBytes file_;
  std::vector<Chunk> chunks_;
  std::deque<std::pair<std::uint32_t, bag::Buffer>> cache_;
};

namespace {

/// The index of a bag, collected from its records.
struct Index {
  std::vector<std::uint32_t> ids;
  std::vector<BagFile::Connection> connections;
  struct ChunkInfo {
    std::uint64_t position;
    std::uint32_t connections;
  };
  std::vector<ChunkInfo> chunks;

  std::size_t connectionOf(std::uint32_t id) const {
    const auto found = std::find(ids.begin(), ids.end(), id);
    if (found == ids.end()) throw std::runtime_error("there is no connection " + std::to_string(id));
    return static_cast<std::size_t>(found - ids.begin());
  }
};

Index readIndex(const bag::Bytes& file, const std::string& path) {
  const std::uint64_t size = file.size();
  if (size < kEndOfFirstRecord) {
    throw std::runtime_error(path + (isActive(path) ? ": is a recording that was cut off" : ": is cut off") +
                             " before anything was written: nothing is in it that could be repaired");
  }
  const bag::Record header = bag::readRecord(file, kMagic.size(), size, Op::kFileHeader);
  if (header.fields.has("encryptor") && !header.fields.text("encryptor").empty())
    throw std::runtime_error(path + ": is encrypted (" + header.fields.text("encryptor") +
                             "), which is not supported");
  std::uint64_t position = header.fields.u64("index_pos");
  if (position == 0 || position > size) throw notClosed(path);
  Index index;
  for (std::uint32_t i = header.fields.u32("conn_count"); i > 0; --i) {
    const bag::Record record = bag::readRecord(file, position, size, Op::kConnection);
    const bag::Fields says(bag::readData(file, record, kLargestConnection));
    index.ids.push_back(record.fields.u32("conn"));
    index.connections.push_back({record.fields.text("topic"), says.text("type"), says.text("md5sum")});
    position = record.end();
  }
  for (std::uint32_t i = header.fields.u32("chunk_count"); i > 0; --i) {
    const bag::Record record = bag::readRecord(file, position, size, Op::kChunkInfo);
    index.chunks.push_back({record.fields.u64("chunk_pos"), record.fields.u32("count")});
    position = record.end();
  }
  return index;
}

/// Appends the entries of one record to those of its connection. @return where the record ends
std::uint64_t readEntries(const bag::Bytes& file, std::uint64_t position, std::uint32_t chunk,
                          const Index& index, std::vector<std::vector<BagFile::Entry>>& entries) {
  constexpr std::size_t kBytes = 12;
  const bag::Record record = bag::readRecord(file, position, file.size(), Op::kIndex);
  const std::uint32_t count = record.fields.u32("count");
  if (count * static_cast<std::uint64_t>(kBytes) != record.data_size)
    throw std::runtime_error("record at byte " + std::to_string(position) + ": lists " +
                             std::to_string(count) + " messages in " + std::to_string(record.data_size) +
                             " bytes");
  const std::vector<std::uint8_t> data = bag::readData(file, record, record.data_size);
  auto& of_connection = entries[index.connectionOf(record.fields.u32("conn"))];
  for (std::size_t at = 0; at < data.size(); at += kBytes) {
    of_connection.push_back({bag::timeOf(bag::littleEndian(&data[at], 8)), chunk,
                             static_cast<std::uint32_t>(bag::littleEndian(&data[at + 8], 4))});
  }
  return record.end();
}

}  // namespace

BagFile::BagFile(const std::string& path) : path_(path) {
  requireFile(path);
  try {
    chunks_ = std::make_unique<Chunks>(path);
    requireMagic(path, chunks_->file());
    Index index = readIndex(chunks_->file(), path);
    entries_.resize(index.ids.size());
    std::uint64_t size_of_index = 0;
    for (const Index::ChunkInfo& info : index.chunks) {
      const auto chunk = static_cast<std::uint32_t>(chunks_->size());
      const std::uint64_t begin = chunks_->add(info.position);
      std::uint64_t position = begin;
      for (std::uint32_t i = 0; i < info.connections; ++i)
        position = readEntries(chunks_->file(), position, chunk, index, entries_);
      size_of_index += position - begin;
      if (size_of_index > chunks_->file().size())
        throw std::runtime_error("the same part of the index belongs to several chunks");
    }
    for (auto& entries : entries_) {
      std::stable_sort(entries.begin(), entries.end(),
                       [](const Entry& a, const Entry& b) { return a.time < b.time; });
    }
    connections_ = std::move(index.connections);
    ids_ = std::move(index.ids);
  } catch (const std::runtime_error& error) {
    const std::string reason = error.what();
    if (reason.rfind(path, 0) == 0) throw;
    throw std::runtime_error(path + ": is damaged: " + reason + " ('rosbag reindex' may repair it)");
  }
}

BagFile::~BagFile() = default;

std::vector<std::uint8_t> BagFile::read(std::size_t connection, const Entry& entry) {
  try {
    return chunks_->read(entry.chunk, entry.offset, ids_.at(connection));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path_ + ": is damaged: " + error.what());
  }
}

}  // namespace rgbd_sfm_fusion
